//! `afmsweep completions SHELL` and `afmsweep man`: what a shell and a reader of manuals want of a program.

use super::{Cli, print};
use clap::{Command, CommandFactory};

#[derive(clap::Args)]
#[command(
    after_help = "Example: afmsweep completions bash > ~/.local/share/bash-completion/completions/afmsweep"
)]
pub struct CompletionsArgs {
    /// Shell
    shell: clap_complete::Shell,
}

/// Prints the script that completes commands and options.
pub fn completions(args: &CompletionsArgs) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "afmsweep", &mut script);
    print(&String::from_utf8(script)?)
}

/// Prints one page about the program and all its commands, in the form that `man` reads.
pub fn man() -> anyhow::Result<()> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let mut page = Vec::new();
    clap_mangen::Man::new(program.clone()).render(&mut page)?;
    for command in program.get_subcommands() {
        let name = format!("afmsweep {}", command.get_name());
        page.extend(format!(".SH \"{}\"\n", name.to_uppercase()).bytes());
        of_command(command.clone().display_name(name), &mut page)?;
    }
    print(&String::from_utf8(page)?)
}

/// What the command does, how it is called, and its options.
fn of_command(command: Command, page: &mut Vec<u8>) -> anyhow::Result<()> {
    let man = clap_mangen::Man::new(command);
    let mut part = Vec::new();
    man.render_description_section(&mut part)?;
    man.render_synopsis_section(&mut part)?;
    man.render_options_section(&mut part)?;
    // A section of its own has the command; these are below it.
    page.extend(String::from_utf8(part)?.replace(".SH ", ".SS ").bytes());
    Ok(())
}
