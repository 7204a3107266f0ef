//! One script of many modules: each becomes a function that returns what it exports, and the names that it imports are looked up in what
//! the others have returned. The modules of the page keep to the few forms that are read here, each on a line of its own:
//! `import { a, b as c } from "./x.js";`, or from `"../folder/x.js"`, and `export [async] function|const|class NAME`.

use std::collections::BTreeMap;
use std::fmt::Write;

/// The name by which the script has what its main module exports.
pub const NAME: &str = "twinslipExplore";

/// A module, read.
struct Module {
    /// Its lines without `import` and `export`.
    body: String,
    /// The files that it imports, and the names in them.
    imports: Vec<(String, String)>,
    exports: Vec<String>,
}

/// The script of these modules, named by their files; `main` is the module that the others are for, and what it exports is
/// `twinslipExplore` to what follows.
///
/// # Errors
/// A sentence with file and line, for a form that is not known, a file that is not there, and imports that go round in a circle.
pub fn bundle<S: AsRef<str>>(modules: &[(String, S)], main: &str) -> Result<String, String> {
    let mut read = BTreeMap::new();
    for (name, text) in modules {
        read.insert(name.as_str(), module(name, text.as_ref())?);
    }
    let mut script = format!("const {NAME} = (() => {{\n\"use strict\";\nconst modules = {{}};\n");
    let mut done = Vec::new();
    add(main, &read, &mut Vec::new(), &mut done, &mut script)?;
    writeln!(script, "return modules[{main:?}];\n}})();").expect("writing to a string");
    Ok(script)
}

/// Adds a module behind those that it imports, unless it is there.
fn add<'a>(
    name: &'a str,
    modules: &'a BTreeMap<&str, Module>,
    above: &mut Vec<&'a str>,
    done: &mut Vec<&'a str>,
    script: &mut String,
) -> Result<(), String> {
    if done.contains(&name) {
        return Ok(());
    }
    if above.contains(&name) {
        return Err(format!(
            "imports go round in a circle: {} -> {name}",
            above.join(" -> ")
        ));
    }
    let from = above.last().unwrap_or(&"the page");
    let module = modules
        .get(name)
        .ok_or(format!("{from} imports {name}, which is not there"))?;
    above.push(name);
    let mut head = String::new();
    for (file, names) in &module.imports {
        add(file, modules, above, done, script)?;
        let known = &modules[file.as_str()].exports;
        let names: Vec<&str> = names
            .split(',')
            .map(str::trim)
            .filter(|one| !one.is_empty())
            .collect();
        let imported = |one: &&str| {
            one.split(" as ")
                .next()
                .unwrap_or_default()
                .trim()
                .to_owned()
        };
        if let Some(missing) = names.iter().map(imported).find(|one| !known.contains(one)) {
            return Err(format!(
                "{name} imports {missing}, which {file} does not export"
            ));
        }
        let names: Vec<String> = names.iter().map(|one| one.replace(" as ", ": ")).collect();
        writeln!(
            head,
            "const {{ {} }} = modules[{file:?}];",
            names.join(", ")
        )
        .expect("writing to a string");
    }
    above.pop();
    done.push(name);
    let (body, exports) = (&module.body, module.exports.join(", "));
    write!(
        script,
        "modules[{name:?}] = (() => {{\n{head}{body}return {{ {exports} }};\n}})();\n"
    )
    .expect("writing to a string");
    Ok(())
}

/// The module at a path relative to another one, from the folder of all; none for a path that begins with neither `./` nor `../`.
fn beside(name: &str, path: &str) -> Option<String> {
    let mut folders: Vec<&str> = name.split('/').collect();
    folders.pop();
    let mut parts = path.split('/').peekable();
    parts.peek().filter(|first| [".", ".."].contains(first))?;
    for part in parts {
        match part {
            "." => {}
            ".." => {
                folders.pop()?;
            }
            part => folders.push(part),
        }
    }
    Some(folders.join("/"))
}

fn module(name: &str, text: &str) -> Result<Module, String> {
    let mut module = Module {
        body: String::with_capacity(text.len()),
        imports: Vec::new(),
        exports: Vec::new(),
    };
    for (number, line) in text.lines().enumerate() {
        let wrong = |what: &str| Err(format!("{name}:{}: {what}: {line}", number + 1));
        if let Some(rest) = line.strip_prefix("import ") {
            let parts = rest
                .trim_end()
                .strip_prefix('{')
                .and_then(|rest| rest.split_once('}'));
            let file = parts
                .and_then(|(_, from)| from.trim().strip_prefix("from \"")?.strip_suffix("\";"))
                .and_then(|path| beside(name, path));
            match (parts, file) {
                (Some((names, _)), Some(file)) => {
                    module.imports.push((file, names.to_owned()));
                }
                _ => return wrong("this form of import is not known"),
            }
            continue;
        }
        let Some(declared) = line.strip_prefix("export ") else {
            module.body.push_str(line);
            module.body.push('\n');
            continue;
        };
        let kinds = [
            "async function* ",
            "async function ",
            "function* ",
            "function ",
            "const ",
            "class ",
        ];
        let named = kinds.iter().find_map(|kind| declared.strip_prefix(kind));
        let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
        let end = |rest: &str| rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        match named.map(|rest| &rest[..end(rest)]) {
            Some(name) if !name.is_empty() => module.exports.push(name.to_owned()),
            _ => return wrong("this form of export is not known"),
        }
        module.body.push_str(declared);
        module.body.push('\n');
    }
    Ok(module)
}
