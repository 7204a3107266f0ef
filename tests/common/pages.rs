//! Reports to try the page with: a small one as it is meant, and one with contents that break pages.

use twinslip_output::page::{Figure, FileRow, Page, Score, Table};

/// A picture of that size.
pub fn picture(width: u32, height: u32) -> String {
    format!(
        r##"<svg width="{width}" height="{height}" viewBox="0 0 {width} {height}" xmlns="http://www.w3.org/2000/svg">
<rect x="0" y="0" width="{width}" height="{height}" fill="#FFFFFF"/><circle cx="50" cy="50" r="40" fill="#0072B2"/></svg>"##
    )
}

pub fn score(id: &str, verdict: &str) -> Score {
    Score {
        id: id.into(),
        place: "Fig. 16, caption".into(),
        quantity: "period doubling at K = 0.14, V_H".into(),
        printed: "0.0842".into(),
        computed: "0.0884208239 ± 2e-10".into(),
        second: "0.08842082 (collocation)".into(),
        difference: (verdict != "agrees").then_some(-0.0478),
        verdict: verdict.into(),
        note: "Two independent methods agree.".into(),
    }
}

/// A report of two figures and a table.
pub fn plain() -> Page {
    let figure = |id: &str, title: &str| Figure {
        id: id.into(),
        title: title.into(),
        caption: "The first paragraph,\nof two lines.\n\nThe second paragraph.".into(),
        alt: format!("A blue disc that stands for {title}."),
        svg: picture(560, 470),
        svg_file: format!("{id}.svg"),
        csv_file: format!("{id}.csv"),
        method: "Rosenbrock method with relative tolerance 1e-10.".into(),
        seconds: Some(3.24),
        scenes: vec![(format!("{id}.toml"), "driving = 0.2 # V_H\n".into())],
    };
    Page {
        title: "Sliding modes".into(),
        lead: vec!["What was computed.".into(), "What came out of it.".into()],
        facts: vec![("entries that agree".into(), "1 of 3".into())],
        scores: vec![
            score("first", "agrees"),
            score("second", "misprint"),
            score("third", "differs"),
        ],
        figures: vec![
            figure("fig07", "Branches at K = 0.14"),
            figure("fig10a", "A cycle"),
        ],
        tables: vec![Table {
            id: "table1".into(),
            title: "Resonances".into(),
            caption: "On the torus curve.".into(),
            csv_file: "table1.csv".into(),
            columns: vec!["resonance".into(), "V_H".into()],
            rows: vec![vec!["1:2".into(), "0.0993643289".into()]],
        }],
        manifest: vec![("version".into(), "0.1.0".into())],
        files: vec![FileRow {
            name: "fig07.csv".into(),
            bytes: 1_234_567,
            sha256: "0f".repeat(32),
        }],
    }
}

/// A report whose every text is long, without blanks, or looks like HTML.
pub fn hostile() -> Page {
    let long = "Neimark-Sacker".repeat(20).replace('-', "");
    let markup = r#"</p><script>document.title = "taken"</script><img src="http://127.0.0.1:9/x.png" onerror="x()"> & "quotes" 'single' &lt;"#;
    let text = format!("{markup} {long}");
    let file = format!("{}&<b>#?%20 \"'.csv", "x".repeat(200));
    let number = "0.".to_owned() + &"123456789".repeat(20) + " ± 1e-180";
    let score = |id: usize, verdict: &str| Score {
        id: format!("{long}{id} & <b>"),
        place: text.clone(),
        quantity: text.clone(),
        printed: number.clone(),
        computed: number.clone(),
        second: format!("{number} ({long})"),
        difference: [None, Some(f64::NAN), Some(1e300)][id % 3],
        verdict: verdict.into(),
        note: text.repeat(5),
    };
    let figure = |id: &str, width: u32, height: u32| Figure {
        id: id.into(),
        title: text.clone(),
        caption: format!("{text}\n\n{}", "many words ".repeat(300)),
        alt: text.clone(),
        svg: picture(width, height),
        svg_file: file.replace("csv", "svg"),
        csv_file: file.clone(),
        method: text.clone(),
        seconds: Some(1e7),
        scenes: vec![(
            file.clone(),
            format!("{text}\n{}\n", "key = 1 ".repeat(100)),
        )],
    };
    Page {
        title: text.clone(),
        lead: vec![text.clone(), long.clone()],
        facts: (0..9).map(|_| (text.clone(), number.clone())).collect(),
        scores: ["agrees", "differs", "misprint", "undecided", "agrees"]
            .iter()
            .enumerate()
            .map(|(i, verdict)| score(i, verdict))
            .chain([score(9, &long), Score::default()])
            .collect(),
        figures: vec![
            figure("fig01", 4000, 300),
            figure("fig 02 & <b>", 60, 3000),
            figure(&long, 560, 470),
            Figure {
                id: "fig04".into(),
                ..Figure::default()
            },
        ],
        tables: vec![
            Table {
                id: "table1".into(),
                title: text.clone(),
                caption: text.clone(),
                csv_file: file.clone(),
                columns: (0..60).map(|i| format!("column_{i}")).collect(),
                rows: vec![
                    vec![number.clone(); 60],
                    vec![text.clone(); 60],
                    vec!["-1".into()],
                ],
            },
            Table {
                id: "table2".into(),
                ..Table::default()
            },
        ],
        manifest: vec![(long.clone(), text.clone()), (text.clone(), long.clone())],
        files: vec![
            FileRow {
                name: file,
                bytes: u64::MAX,
                sha256: "0123456789abcdef".repeat(4),
            },
            FileRow {
                name: "//127.0.0.1:9/away.csv".into(),
                bytes: 0,
                sha256: String::new(),
            },
            FileRow {
                name: "javascript:x()".into(),
                bytes: 1,
                sha256: long,
            },
        ],
    }
}
