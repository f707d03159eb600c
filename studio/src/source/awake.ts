// The screen is kept awake while the page is seen.

export async function keepAwake(tell: (awake: boolean) => void) {
  const ask = async () => {
    try {
      await navigator.wakeLock.request("screen");
      tell(true);
    } catch {
      // Not offered, not allowed, or the battery is low.
      tell(false);
    }
  };
  // A page that was hidden has lost it.
  document.addEventListener("visibilitychange", () => {
    if (document.visibilityState === "visible") void ask();
  });
  await ask();
}
