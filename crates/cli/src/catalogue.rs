//! The options of the commands, told: for programs that offer them under the same names.

use std::any::TypeId;
use std::path::PathBuf;
use twinslip_tasks::scene::Command;

/// What an option takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionKind {
    /// Nothing: it is there or not.
    Switch,
    /// A finite number.
    Number,
    /// A whole number, not negative.
    Count,
    /// The name of a file.
    File,
    /// Text: a name, or numbers in a form of their own.
    Text,
}

impl OptionKind {
    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            OptionKind::Switch => "switch",
            OptionKind::Number => "number",
            OptionKind::Count => "count",
            OptionKind::File => "file",
            OptionKind::Text => "text",
        }
    }
}

/// An option of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OptionInfo {
    /// Its name, without dashes; that of the argument where it is written without.
    pub name: String,
    /// Whether it is written without a name.
    pub positional: bool,
    /// What it takes.
    pub kind: OptionKind,
    /// The form of its value, such as `A:B:N[log]`.
    pub form: String,
    /// Whether it may be given again.
    pub repeated: bool,
    /// The value where it is not given, where that is one for all.
    pub default: Option<String>,
    /// What it is about, such as Model or Numerics.
    pub heading: String,
    /// What it means.
    pub help: String,
}

/// The names of the commands that compute, in their order, with what each does.
pub fn commands() -> Vec<(String, String)> {
    let text = |command: &clap::Command| {
        command
            .get_about()
            .map_or(String::new(), |about| about.to_string())
    };
    let program = Command::program();
    let commands = program.get_subcommands();
    commands
        .map(|command| (command.get_name().to_owned(), text(command)))
        .collect()
}

/// The options of a command, in the order of its help; none where there is no such command.
pub fn options(command: &str) -> Vec<OptionInfo> {
    let mut program = Command::program();
    program.build();
    let Some(command) = program.find_subcommand(command) else {
        return Vec::new();
    };
    let own = command
        .get_arguments()
        .filter(|argument| !["help", "version"].contains(&argument.get_id().as_str()));
    own.map(option).collect()
}

fn option(argument: &clap::Arg) -> OptionInfo {
    let taken = argument.get_value_parser().type_id();
    let is = |type_id: TypeId| taken == type_id;
    let kind = match () {
        () if !argument.get_action().takes_values() => OptionKind::Switch,
        () if is(TypeId::of::<f64>()) => OptionKind::Number,
        () if is(TypeId::of::<usize>()) || is(TypeId::of::<u32>()) || is(TypeId::of::<u64>()) => {
            OptionKind::Count
        }
        () if is(TypeId::of::<PathBuf>()) => OptionKind::File,
        () => OptionKind::Text,
    };
    let forms = argument.get_value_names().unwrap_or_default();
    let forms: Vec<&str> = forms.iter().map(AsRef::as_ref).collect();
    let default = argument
        .get_default_values()
        .first()
        .map(|text| text.to_string_lossy().into_owned());
    OptionInfo {
        name: argument
            .get_long()
            .unwrap_or(argument.get_id().as_str())
            .to_owned(),
        positional: argument.is_positional(),
        kind,
        form: if kind == OptionKind::Switch {
            String::new()
        } else {
            forms.join(" ")
        },
        repeated: matches!(argument.get_action(), clap::ArgAction::Append),
        default: default.filter(|_| kind != OptionKind::Switch),
        heading: argument.get_help_heading().unwrap_or_default().to_owned(),
        help: argument
            .get_help()
            .map_or(String::new(), |help| help.to_string()),
    }
}
