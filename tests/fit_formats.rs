//! Files as spreadsheets, repositories and instruments write them: encodings, separators, digits in groups, clocks, heads.

use super::command::{folder, refused_in_one_line, run};
use super::fit_records::{comma, fitted, is_the_truth, samples, shown};
use std::fs;

/// A file: its name, its head, what its rows are, and how its text becomes bytes.
struct File {
    name: &'static str,
    head: &'static str,
    row: fn(usize, f64, f64, f64) -> String,
    bytes: fn(&str) -> Vec<u8>,
}

fn utf8(text: &str) -> Vec<u8> {
    text.into()
}

fn wide(text: &str, mark: bool, of: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mark = Some(0xfeff).filter(|_| mark);
    mark.into_iter()
        .chain(text.encode_utf16())
        .flat_map(of)
        .collect()
}

fn tabs(_: usize, t: f64, x: f64, mu: f64) -> String {
    shown(&[t, x * 1e6, mu]).join("\t") + "\r\n"
}

/// `12345.678` as `12,345.678`.
fn grouped(x: f64) -> String {
    let text = format!("{x:.4}");
    let (whole, rest) = text.split_once('.').expect("a point");
    match whole.len() {
        ..=3 => text,
        n => format!("{},{}.{rest}", &whole[..n - 3], &whole[n - 3..]),
    }
}

/// The same as German spreadsheets have it.
fn grouped_german(x: f64) -> String {
    let swap = |c: char| match c {
        ',' => '.',
        '.' => ',',
        c => c,
    };
    grouped(x).chars().map(swap).collect()
}

const FILES: [File; 16] = [
    // As xlook writes its tables: numbered rows, whose numbers have no name.
    File {
        name: "xlook.txt",
        head: "number of records = 424645\n            col 1       col 2       col 3       col 4       col 5       col 9      col 10\n          LP_Disp  Shr_stress    nor_disp  Nor_stress        Time   Samp_Freq          mu\n              mic         MPa      micron         MPa         sec          Hz           .\n      424645 recs 424645 recs 424645 recs 424645 recs 424645 recs 424645 recs 424645 recs\n",
        row: |i, t, x, mu| {
            let cells = shown(&[
                x * 1e6 + 4643.5,
                8.0 * mu,
                -782.0,
                8.0,
                t + 2531.0,
                10.0,
                mu,
            ]);
            format!("{:6} {}\n", 87_309 + i, cells.join("  "))
        },
        bytes: utf8,
    },
    // As R's write.table does.
    File {
        name: "r.txt",
        head: "\"time_s\" \"displacement_um\" \"friction\"\n",
        row: |i, t, x, mu| format!("\"{}\" {}\n", i + 1, shown(&[t, x * 1e6, mu]).join(" ")),
        bytes: utf8,
    },
    File {
        name: "excel-german.csv",
        head: "sep=;\r\nZeit (s);Weg (µm);Reibungskoeffizient;;\r\n",
        row: |_, t, x, mu| {
            let cells = comma(&[t, mu]);
            format!(
                "{};{};{};;\r\n",
                cells[0],
                grouped_german(x * 1e6 + 1e3),
                cells[1]
            )
        },
        bytes: |text| [b"\xef\xbb\xbf", text.as_bytes()].concat(),
    },
    File {
        name: "excel-english.csv",
        head: "Time (s),LP disp (um),Friction,,\r\n",
        row: |_, t, x, mu| format!("{t},\"{}\",{mu},,\r\n", grouped(x * 1e6 + 1e3)),
        bytes: utf8,
    },
    File {
        name: "utf-16-le.txt",
        head: "Time (s)\tDisplacement (µm)\tFriction\r\n",
        row: tabs,
        bytes: |text| wide(text, true, u16::to_le_bytes),
    },
    File {
        name: "utf-16-be.txt",
        head: "Time (s)\tDisplacement (µm)\tFriction\r\n",
        row: tabs,
        bytes: |text| wide(text, true, u16::to_be_bytes),
    },
    File {
        name: "utf-16-without-mark.txt",
        head: "Time (s)\tDisplacement (µm)\tFriction\r\n",
        row: tabs,
        bytes: |text| wide(text, false, u16::to_le_bytes),
    },
    File {
        name: "pangaea.tab",
        head: "/* DATA DESCRIPTION:\nCitation:\tAuthor (2020): friction, time, displacement\nParameter(s):\tTime [s] (Time)\n*/\n\
               Time [s] (elapsed)\tLoad point (LP) displ [µm]\tFric coeff (µ)\n",
        row: tabs,
        bytes: utf8,
    },
    File {
        name: "date-beside-seconds.csv",
        head: "Date;Elapsed;Displacement (mm);mu\n",
        row: |_, t, x, mu| format!("2023-05-01 12:00:00;{t};{};{mu}\n", x * 1e3),
        bytes: utf8,
    },
    File {
        name: "units-in-a-row.csv",
        head: "Experiment,b12\nRate (Hz),10\nRow,Time,LP_disp,EC_disp,Shear stress,Normal stress,Comment\n,s,micron,micron,MPa,MPa,\n",
        row: |i, t, x, mu| {
            let comment = if i == 3 { "x" } else { "" };
            format!(
                "{i},{t},{},{},{},20,{comment}\n",
                x * 1e6,
                x * 9e5,
                mu * 20.0
            )
        },
        bytes: utf8,
    },
    File {
        name: "returns-alone.txt",
        head: "Time (s)\tDisplacement (µm)\tFriction\r",
        row: |i, t, x, mu| tabs(i, t, x, mu).replace('\n', ""),
        bytes: |text| text.chars().map(|c| c as u8).collect(),
    },
    File {
        name: "code-page-437.txt",
        head: "Time (s)\tDisplacement (µm)\tFriction\n",
        row: tabs,
        bytes: |text| {
            text.chars()
                .map(|c| if c == 'µ' { 0xe6 } else { c as u8 })
                .collect()
        },
    },
    File {
        name: "matlab.txt",
        head: "% Time (s)   Displacement (um)   Friction\n",
        row: |_, t, x, mu| format!("   {t:.7e}   {:.7e}   {mu:.9e}\n", x * 1e6),
        bytes: utf8,
    },
    File {
        name: "names-of-words.txt",
        head: "Elapsed time (s)   Load point displacement (um)   Coefficient of friction\n",
        row: |i, t, x, mu| tabs(i, t, x, mu).replace('\t', "   "),
        bytes: utf8,
    },
    File {
        name: "italian.txt",
        head: "Tempo [s]\tSpostamento [mm]\tSforzo di taglio [MPa]\tSforzo normale [MPa]\n",
        row: |_, t, x, mu| comma(&[t, x * 1e3, mu * 5.0, 5.0]).join("\t") + "\n",
        bytes: utf8,
    },
    File {
        name: "japanese.csv",
        head: "jikan_s,heni_um,masatsu keisu\n",
        row: |i, t, x, mu| tabs(i, t, x, mu).replace('\t', ","),
        bytes: utf8,
    },
];

#[test]
fn files_of_spreadsheets_and_repositories_are_read() {
    let folder = folder("fit_formats");
    for file in FILES {
        let rows = samples().enumerate();
        let rows = rows.map(|(i, (t, x, mu))| (file.row)(i, t, x, mu));
        let text: String = std::iter::once(file.head.to_owned()).chain(rows).collect();
        let path = folder.join(file.name);
        fs::write(&path, (file.bytes)(&text)).expect("a file");
        let result = fitted(&path, &[]);
        is_the_truth(file.name, &result);
        let notes = result["notes"].as_array().expect("a list");
        assert!(notes.is_empty(), "{}: {notes:?}", file.name);
    }
}

/// A clock that passes midnight, and a velocity in place of the displacement, are said to be taken so.
#[test]
fn clocks_and_velocities_are_taken_and_told() {
    let folder = folder("fit_clocks");
    let clock = |_: usize, t: f64, x: f64, mu: f64| {
        let whole = 86_390.0 + t;
        let (day, second) = (1.0 + (whole / 86_400.0).floor(), whole % 86_400.0);
        let (hours, rest) = ((second / 3600.0).floor(), second % 3600.0);
        let (minutes, seconds) = ((rest / 60.0).floor(), rest % 60.0);
        format!(
            "2023-05-{day:02}T{hours:02}:{minutes:02}:{seconds:06.3},{},{mu}\n",
            x * 1e6
        )
    };
    let velocity = |_: usize, t: f64, _: f64, mu: f64| {
        let v = if t <= 20.0 { 1.0 } else { 10.0 };
        format!("{t},{v},{mu}\n")
    };
    type Row<'a> = &'a dyn Fn(usize, f64, f64, f64) -> String;
    let files: [(&str, &str, Row<'_>, &str); 2] = [
        (
            "clock.csv",
            "Timestamp,displacement_um,friction\n",
            &clock,
            "are of a clock",
        ),
        (
            "velocity.csv",
            "time_s,velocity_um/s,friction\n",
            &velocity,
            "is integrated, as there is no displacement",
        ),
    ];
    for (name, head, row, says) in files {
        let rows = samples()
            .enumerate()
            .map(|(i, (t, x, mu))| row(i, t, x, mu));
        let text: String = std::iter::once(head.to_owned()).chain(rows).collect();
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        let result = fitted(&path, &[]);
        assert!(
            result["notes"][0].as_str().expect("a text").contains(says),
            "{}",
            result["notes"]
        );
        let found = result["fit"]["parameters"].as_array().expect("a list");
        let length = found
            .iter()
            .find(|one| one["name"] == "slip_length")
            .expect("it");
        let off = length["value"].as_f64().expect("a number") / 1e-5 - 1.0;
        assert!(off.abs() < 0.02, "{name}: {off:e}");
    }
}

#[test]
fn what_may_be_several_things_or_is_no_text_is_refused() {
    let folder = folder("fit_ambiguous");
    let with = |name: &str, head: &str, row: fn(f64, f64, f64) -> String| {
        let rows = samples().map(|(t, x, mu)| row(t, x * 1e6, mu));
        let text: String = std::iter::once(head.to_owned()).chain(rows).collect();
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let two = with(
        "two.csv",
        "time_s,displacement_1_um,displacement_2_um,friction\n",
        |t, x, mu| format!("{t},{x},{},{mu}\n", 0.9 * x),
    );
    let bare = with("bare.txt", "", |t, x, mu| format!("{t} {x} {mu}\n"));
    let sheet = folder.join("sheet.xlsx");
    fs::write(&sheet, b"PK\x03\x04\0\0").expect("a file");
    for (file, says) in [
        (
            &two,
            "the columns displacement_1_um and displacement_2_um may each be the displacement; say which by --displacement",
        ),
        (&bare, "there is no header, and 3 columns: 1 from 0 to 39.9"),
        (
            &sheet.display().to_string(),
            "it is a spreadsheet or an archive; save its sheet as CSV",
        ),
    ] {
        refused_in_one_line(&format!("fit {file} --law slip"), says);
    }
    // Where the load point moves by a program, no displacement is needed.
    let ended = run(&[
        "fit",
        &two,
        "--law=slip",
        "--program=20:1e-5",
        "--driving=1e-6",
        "--stiffness=0.5/um",
        "--intervals=linear",
        "--format=json",
    ]);
    assert_eq!(ended.code, 0, "{}", ended.err);
    assert!(
        ended.err.contains("none is taken of the columns"),
        "{}",
        ended.err
    );
    // What the columns were taken to be is said.
    let ended = run(&[
        "fit",
        &two,
        "--displacement=displacement_1_um",
        "--law=slip",
        "--stiffness=0.5/um",
        "--intervals=linear",
        "--format=json",
    ]);
    let says = "two.csv: time from \"time_s\" [s], displacement from \"displacement_1_um\" [um], friction from \"friction\"";
    assert!(ended.err.contains(says), "{}", ended.err);
}
