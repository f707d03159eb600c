//! The commands, one file each: its arguments and what it does.

mod apply;
mod calibrate;
pub mod check;
pub mod compensate;
mod completions;
mod demo;
mod draw;
mod evaluate;
mod explore;
mod eyebox;
mod man;
mod map;
mod measure;
mod new;
mod orbit;
mod pattern;
mod plate;
#[cfg_attr(not(feature = "show"), path = "play_without.rs")]
mod play;
mod report;
mod schema;
mod studio;
mod tolerance;
mod view;
mod weights;

use crate::failure::Failure;
use crate::summary::Voice;
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// What a display must show so that its mid-air image looks undistorted
///
/// A scene file describes the viewpoint, the mid-air image, transparent and reflective objects, the micro-mirror array plate and the display.
/// midair computes what the display must show, and verifies it by simulating what the viewer sees.
#[derive(Debug, Parser)]
#[command(name = "midair", version, arg_required_else_help = true, max_term_width = 100)]
#[command(
    after_help = "Start with:\n  midair demo\n  midair new\n\nExit codes: 0 done; 2 not done, and a message says why; 130 interrupted."
)]
pub struct Program {
    #[command(subcommand)]
    command: Command,
    /// Print the summary as JSON on standard output
    #[arg(long, global = true)]
    json: bool,
    /// Explain what is done
    #[arg(short, long, global = true)]
    verbose: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Arguments),
    New(new::Arguments),
    Compensate(compensate::Arguments),
    Apply(apply::Arguments),
    Play(play::Arguments),
    View(view::Arguments),
    Check(check::Arguments),
    Draw(draw::Arguments),
    Pattern(pattern::Arguments),
    Plate(plate::Arguments),
    Tolerance(tolerance::Arguments),
    Explore(explore::Arguments),
    Report(report::Arguments),
    Calibrate(calibrate::Arguments),
    Orbit(orbit::Arguments),
    Eyebox(eyebox::Arguments),
    Map(map::Arguments),
    Measure(measure::Arguments),
    Evaluate(evaluate::Arguments),
    Weights(weights::Arguments),
    Studio(studio::Arguments),
    Schema(schema::Arguments),
    Completions(completions::Arguments),
    Man(man::Arguments),
}

/// Does what the command line asks for.
pub fn run(program: Program) -> Result<ExitCode, Failure> {
    let voice = Voice { json: program.json, verbose: program.verbose };
    match program.command {
        // The one that can be interrupted and still has something to show.
        Command::View(arguments) => return view::run(&arguments, voice),
        Command::Demo(arguments) => demo::run(&arguments, voice),
        Command::New(arguments) => new::run(&arguments, voice),
        Command::Compensate(arguments) => compensate::run(&arguments, voice),
        Command::Apply(arguments) => apply::run(&arguments, voice),
        Command::Play(arguments) => play::run(&arguments, voice),
        Command::Check(arguments) => check::run(&arguments, voice),
        Command::Draw(arguments) => draw::run(&arguments, voice),
        Command::Pattern(arguments) => pattern::run(&arguments, voice),
        Command::Plate(arguments) => plate::run(&arguments, voice),
        Command::Tolerance(arguments) => tolerance::run(&arguments, voice),
        Command::Explore(arguments) => explore::run(&arguments, voice),
        Command::Report(arguments) => report::run(&arguments, voice),
        Command::Calibrate(arguments) => calibrate::run(&arguments, voice),
        Command::Orbit(arguments) => orbit::run(&arguments, voice),
        Command::Eyebox(arguments) => eyebox::run(&arguments, voice),
        Command::Map(arguments) => map::run(&arguments, voice),
        Command::Measure(arguments) => measure::run(&arguments, voice),
        Command::Evaluate(arguments) => evaluate::run(&arguments, voice),
        Command::Weights(arguments) => weights::run(&arguments, voice),
        Command::Studio(arguments) => studio::run(&arguments, voice),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Man(arguments) => man::run(&arguments, voice),
    }?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_command_line_is_consistent_and_every_command_has_an_example() {
        Program::command().debug_assert();
        let program = Program::command();
        for command in
            program.get_subcommands().flat_map(|c| std::iter::once(c).chain(c.get_subcommands()))
        {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains("Example"), "{}", command.get_name());
        }
    }

    /// Help is prose for people: no marks of the source that it was written in.
    #[test]
    fn help_texts_are_free_of_source() {
        fn look(command: &mut clap::Command, looked_at: &mut usize) {
            for text in [command.render_help(), command.render_long_help()] {
                let text = text.to_string();
                for (number, line) in text.lines().enumerate() {
                    let place = format!("{} {number}: {line}", command.get_name());
                    // A shell's line goes on after a backslash at its end.
                    let inner = line.strip_suffix('\\').unwrap_or(line);
                    assert!(!inner.contains('\\'), "{place}");
                    assert!(
                        !["///", "[`", "`]", "::", "&mut", "TODO"].iter().any(|m| line.contains(m)),
                        "{place}"
                    );
                }
                assert_eq!(text.matches('"').count() % 2, 0, "{}", command.get_name());
                *looked_at += 1;
            }
            for inner in command.get_subcommands_mut() {
                look(inner, looked_at);
            }
        }
        let (mut program, mut looked_at) = (Program::command(), 0);
        program.build();
        look(&mut program, &mut looked_at);
        assert!(looked_at > 2 * 18, "{looked_at}");
    }
}
