//! `midair new`: a scene to begin from.

use crate::arguments::length;
use crate::failure::Failure;
use crate::summary::{Voice, paths, print, wrote};
use midair::files::write_bytes_atomically;
use midair::geometry::mesh::{self, Surface};
use midair::scene::devices::{self, DISPLAYS, PLATES};
use midair::scene::template::{MeshFile, Template, Wishes};
use midair::scene::{Assets as _, Folder};
use serde_json::json;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

/// Make a scene to begin from: a usual set-up around the plate and the display that you have
///
/// The scene is commented and passes midair check. Without a template, and on a terminal, it asks.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair new cube --plate aska3d-488 --display ipad-10.9 --out scene.toml\n  midair new bunny --mesh bunny.ply\n  midair new --list"
)]
pub struct Arguments {
    /// What to set up; left out, you are asked
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(Template::ALL.map(Template::name)))]
    template: Option<String>,
    /// Scene file to write (TOML)
    #[arg(long, value_name = "FILE", default_value = "scene.toml")]
    out: PathBuf,
    /// The scene's name
    #[arg(long)]
    name: Option<String>,
    /// The plate: a name of the list, or its width and height in mm (300x300)
    #[arg(long, value_name = "NAME|WxH")]
    plate: Option<String>,
    /// The display: a name of the list, or its pixels and the width and height of its lit area in mm (1920x1080@527x296)
    #[arg(long, value_name = "NAME|WxH@WxH")]
    display: Option<String>,
    /// The object's size in mm: a cube's edge, a bottle's or a mesh's height, a mirror's radius
    #[arg(long, value_name = "MM", value_parser = length)]
    object: Option<f64>,
    /// From the viewer's eye to the image, mm
    #[arg(long, value_name = "MM", value_parser = length)]
    eye: Option<f64>,
    /// The mesh of the template bunny: OBJ, STL, PLY, OFF, glTF or GLB
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// List templates, plates and displays
    #[arg(long)]
    list: bool,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    if arguments.list {
        return list(voice);
    }
    if arguments.out.exists() {
        return Err(Failure::new(
            format!("{}: there is such a file already", arguments.out.display()),
            "give the new scene another name by --out, or remove the file",
        ));
    }
    let wishes = match &arguments.template {
        Some(name) => wishes(arguments, name)?,
        None if std::io::stdin().is_terminal() => asked(arguments)?,
        None => {
            return Err(Failure::new(
                "no template is given",
                format!("give one: {}", Template::ALL.map(Template::name).join(", ")),
            ));
        }
    };
    let scene = wishes.scene().map_err(|error| {
        let help = match error {
            midair::scene::template::TemplateError::NoMesh => "give one by --mesh FILE",
            _ => "change the option, or take a larger plate",
        };
        Failure::new(error.to_string(), help)
    })?;
    let (mut output, name) = crate::output::of_file(&arguments.out)?;
    output.write(&name, |path| write_bytes_atomically(path, scene.as_bytes()))?;
    let files = output.finish()?;
    let file = arguments.out.display();
    let told = json!({
        "template": wishes.template.name(),
        "plate": { "name": wishes.plate.1, "size": wishes.plate.0 },
        "display": { "name": wishes.display.2, "resolution": wishes.display.0, "size": wishes.display.1 },
        "files": paths(&files),
    });
    let next = format!(
        "next: midair check {file}; midair draw {file}; midair compensate {file} --image PICTURE --out out\n"
    );
    voice.tell(&format!("{}{next}", wrote(&files)), &told)
}

fn template(name: &str) -> Option<Template> {
    Template::ALL.into_iter().find(|template| template.name() == name)
}

fn wishes(arguments: &Arguments, name: &str) -> Result<Wishes, Failure> {
    let template = template(name).ok_or_else(|| {
        Failure::new(
            format!("there is no template \"{name}\""),
            format!("give one of {}", Template::ALL.map(Template::name).join(", ")),
        )
    })?;
    let mut wishes = Wishes::new(template);
    if let Some(plate) = &arguments.plate {
        wishes.plate = plate_of(plate)?;
    }
    if let Some(display) = &arguments.display {
        wishes.display = display_of(display)?;
    }
    if let Some(name) = &arguments.name {
        wishes.name.clone_from(name);
    }
    wishes.object = arguments.object;
    wishes.eye = arguments.eye;
    if template == Template::Bunny {
        wishes.mesh =
            arguments.mesh.as_deref().map(|file| mesh_of(file, &arguments.out)).transpose()?;
    }
    Ok(wishes)
}

/// Two numbers with an x between.
fn pair<T: std::str::FromStr>(text: &str) -> Option<[T; 2]> {
    let (w, h) = text.split_once(['x', 'X'])?;
    Some([w.trim().parse().ok()?, h.trim().parse().ok()?])
}

fn sensible(size: [f64; 2]) -> bool {
    size.iter().all(|side| (1.0..=10_000.0).contains(side))
}

fn plate_of(text: &str) -> Result<([f64; 2], String), Failure> {
    if let Some(size) = pair(text).filter(|&size| sensible(size)) {
        return Ok((size, "of one's own".to_owned()));
    }
    devices::plate(text)
        .map(|device| (device.size, device.name.to_owned()))
        .map_err(|near| unknown("plate", text, near, "300x300"))
}

fn display_of(text: &str) -> Result<([usize; 2], [f64; 2], String), Failure> {
    let own = text.split_once('@').and_then(|(pixels, size)| {
        let resolution: [usize; 2] = pair(pixels)?;
        let size = pair(size).filter(|&size| sensible(size))?;
        let sound = resolution.iter().all(|side| (1..=32_768).contains(side));
        sound.then(|| (resolution, size, "of one's own".to_owned()))
    });
    if let Some(own) = own {
        return Ok(own);
    }
    devices::display(text)
        .map(Wishes::display_of)
        .map_err(|near| unknown("display", text, near, "1920x1080@527x296"))
}

fn unknown(what: &str, text: &str, near: Option<&str>, own: &str) -> Failure {
    let near = near.map(|near| format!("did you mean {near}? ")).unwrap_or_default();
    Failure::new(
        format!("there is no {what} \"{text}\" in the list"),
        format!("{near}give a name that midair new --list shows, or measures such as {own}"),
    )
}

/// A mesh file's bounds, and its path as the scene file is to name it.
fn mesh_of(file: &Path, scene: &Path) -> Result<MeshFile, Failure> {
    let beside = Folder(file.parent().map(Path::to_path_buf).unwrap_or_default());
    let bytes = Folder::default().read(file).map_err(|error| {
        Failure::new(
            format!("{}: cannot be read: {error}", file.display()),
            "check the path and the permissions",
        )
    })?;
    let (mesh, _) =
        mesh::load(&bytes, file, Surface::Closed, Some(&|name: &Path| beside.read(name)))
            .map_err(|error| Failure::new(error.to_string(), error.help.clone()))?;
    let folder = scene.parent().filter(|folder| !folder.as_os_str().is_empty());
    // Beside the scene a mesh is named as it is; elsewhere by its whole path.
    let named = match folder {
        None if file.is_relative() => file.to_owned(),
        _ => std::fs::canonicalize(file).unwrap_or_else(|_| file.to_owned()),
    };
    Ok(MeshFile { file: named, bounds: mesh.bounds() })
}

fn list(voice: Voice) -> Result<(), Failure> {
    let mut lines = String::from("templates\n");
    for template in Template::ALL {
        lines += &format!("  {:18} {}\n", template.name(), template.about());
    }
    lines += "plates\n";
    for device in &PLATES {
        lines += &format!("  {:18} {} x {} mm\n", device.name, device.size[0], device.size[1]);
    }
    lines += "displays\n";
    for device in &DISPLAYS {
        let ([columns, rows], [w, h]) = (device.resolution, device.size());
        lines += &format!("  {:18} {columns} x {rows} pixels, {w:.1} x {h:.1} mm\n", device.name);
    }
    let told = json!({
        "templates": Template::ALL.map(|t| json!({ "name": t.name(), "about": t.about() })),
        "plates": PLATES.iter().map(|d| json!({ "name": d.name, "size": d.size })).collect::<Vec<_>>(),
        "displays": DISPLAYS
            .iter()
            .map(|d| json!({ "name": d.name, "resolution": d.resolution, "size": d.size() }))
            .collect::<Vec<_>>(),
    });
    voice.tell(&lines, &told)
}

/// Asks for what the command line leaves open. An empty answer takes the usual.
fn asked(arguments: &Arguments) -> Result<Wishes, Failure> {
    let names = Template::ALL.map(Template::name);
    let about: Vec<String> =
        Template::ALL.iter().map(|t| format!("  {:8} {}\n", t.name(), t.about())).collect();
    print(&about.concat())?;
    let name = ask("Which set-up?", names[0], |answer| {
        template(answer)
            .map(|t| t.name().to_owned())
            .ok_or_else(|| format!("one of {}", names.join(", ")))
    })?;
    let mut wishes = wishes(arguments, &name)?;
    let told = |failure: Failure| failure.to_string();
    if arguments.plate.is_none() {
        let names: Vec<&str> = PLATES.iter().map(|d| d.name).collect();
        print(&format!("  {}, or width and height in mm such as 300x300\n", names.join(", ")))?;
        wishes.plate = ask("Which plate?", names[0], |answer| plate_of(answer).map_err(told))?;
    }
    if arguments.display.is_none() {
        let names: Vec<&str> = DISPLAYS.iter().map(|d| d.name).collect();
        print(&format!("  {},\n  or pixels and mm such as 1920x1080@527x296\n", names.join(", ")))?;
        wishes.display =
            ask("Which display?", names[0], |answer| display_of(answer).map_err(told))?;
    }
    if wishes.template == Template::Bunny && wishes.mesh.is_none() {
        let mesh = ask("Which mesh file?", "bunny.ply", |answer| {
            mesh_of(Path::new(answer), &arguments.out).map_err(told)
        })?;
        wishes.mesh = Some(mesh);
    }
    if arguments.eye.is_none() {
        let eye = ask("How far is the viewer's eye from the image, in mm?", "600", length)?;
        wishes.eye = Some(eye);
    }
    Ok(wishes)
}

/// Asks until an answer is understood.
fn ask<T>(
    question: &str,
    usual: &str,
    understand: impl Fn(&str) -> Result<T, String>,
) -> Result<T, Failure> {
    loop {
        print(&format!("{question} [{usual}] "))?;
        let mut answer = String::new();
        let read = std::io::stdin().read_line(&mut answer);
        if !matches!(read, Ok(1..)) {
            return Err(Failure::new("no answer was given", "give a template on the command line"));
        }
        let answer = match answer.trim() {
            "" => usual,
            answer => answer,
        };
        match understand(answer) {
            Ok(value) => return Ok(value),
            Err(why) => {
                let _ = writeln!(std::io::stderr(), "  {why}");
            }
        }
    }
}
