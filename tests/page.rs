//! The report as text: complete, escaped, in order, and the same each time. How it looks is the matter of `tests/browser`.

use crate::common::pages;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use twinslip_output::page::{Figure, Page, Score};

/// The values of all attributes of that name.
fn attributes<'a>(html: &'a str, name: &str) -> Vec<&'a str> {
    html.split(&format!(" {name}=\""))
        .skip(1)
        .map(|rest| rest.split('"').next().expect("a closing quote"))
        .collect()
}

fn place(html: &str, text: &str) -> usize {
    html.find(text).unwrap_or_else(|| panic!("no {text}"))
}

/// A page with nothing but that paragraph.
fn paragraph(text: &str) -> String {
    let html = Page {
        lead: vec![text.into()],
        ..Page::default()
    }
    .html();
    let start = place(&html, "<div class=\"lead\"><p>") + 21;
    html[start..]
        .split("</p>")
        .next()
        .expect("its end")
        .to_owned()
}

fn with_figure(figure: Figure) -> String {
    Page {
        figures: vec![figure],
        ..Page::default()
    }
    .html()
}

fn with_scores(scores: Vec<Score>) -> String {
    Page {
        scores,
        ..Page::default()
    }
    .html()
}

#[test]
fn each_figure_is_listed_drawn_and_linked() {
    let page = pages::plain();
    let html = page.html();
    let images = attributes(&html, "src");
    assert_eq!(images.len(), page.figures.len());
    for (figure, source) in page.figures.iter().zip(images) {
        let links = attributes(&html, "href");
        for target in [
            format!("#{}", figure.id),
            figure.csv_file.clone(),
            figure.svg_file.clone(),
        ] {
            assert!(links.contains(&target.as_str()), "no link to {target}");
        }
        assert!(html.contains(&format!("<section class=\"figure\" id=\"{}\"", figure.id)));
        let coded = source
            .strip_prefix("data:image/svg+xml;base64,")
            .expect("a picture in the file");
        assert_eq!(
            STANDARD.decode(coded).expect("base64"),
            figure.svg.as_bytes()
        );
        assert!(attributes(&html, "alt").contains(&figure.alt.as_str()));
        let (scene, text) = &figure.scenes[0];
        assert!(html.contains(&format!(
            "<code>{scene}</code></summary><pre><code>{text}</code>"
        )));
    }
    let nav = &html[place(&html, "<nav")..place(&html, "</nav>")];
    assert!(
        nav.contains("Figure\u{a0}7")
            && nav.contains("Figure\u{a0}10a")
            && nav.contains("Table\u{a0}1"),
        "{nav}"
    );
    assert!(html.contains("<p>The first paragraph, of two lines.</p><p>The second paragraph.</p>"));
    assert!(html.contains("Took\u{a0}3.2 s of processor time."));
}

#[test]
fn a_picture_keeps_room_of_its_own_size() {
    let drawn = |svg: &str| {
        with_figure(Figure {
            id: "fig01".into(),
            svg: svg.into(),
            alt: "a".into(),
            ..Figure::default()
        })
    };
    let html = drawn(&pages::picture(560, 470));
    assert!(
        html.contains("alt=\"a\" width=\"560\" height=\"470\">"),
        "{html}"
    );
    let html = drawn(
        "<?xml version=\"1.0\"?><svg xmlns=\"x\" stroke-width=\"3\" height=\"80.6px\"><rect width=\"7\"/></svg>",
    );
    assert!(html.contains("alt=\"a\" height=\"81\">"), "{html}");
    assert!(drawn("<svg width=\"100%\" height=\"0\">").contains("alt=\"a\">"));
    assert!(!drawn("").contains("<img"), "no picture, no frame");
}

#[test]
fn whatever_a_text_holds_is_shown_and_not_obeyed() {
    let html = pages::hostile().html();
    for tag in ["<script", "<b>", "<img src=\"http", "\" onerror"] {
        assert!(!html.contains(tag), "{tag}");
    }
    assert!(html.contains("&lt;script&gt;document.title = &quot;taken&quot;&lt;/script&gt;"));
    assert!(
        html.contains(" &amp;lt;"),
        "what is escaped already is escaped again"
    );
    for source in attributes(&html, "src") {
        assert!(source.starts_with("data:image/svg+xml;base64,"), "{source}");
    }
    for address in attributes(&html, "href") {
        let inside = address.starts_with('#') || address == "data:,";
        // no colon and no leading slash: neither a scheme nor another machine
        assert!(
            inside || !(address.contains(':') || address.starts_with('/')),
            "{address}"
        );
    }
    assert!(html.contains("href=\"javascript%3Ax%28%29\""));
    assert!(html.contains("href=\"127.0.0.1%3A9/away.csv\""));
    assert!(
        html.contains("%26%3Cb%3E%23%3F%2520%20%22%27.csv\""),
        "the name of a file, whatever is in it"
    );
}

#[test]
fn nothing_is_loaded_and_nothing_runs() {
    let html = pages::plain().html();
    assert!(html.starts_with("<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\">"));
    assert!(
        html.contains("content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'")
    );
    for word in ["<script", "http://", "https://", "@import", "url("] {
        assert!(!html.contains(word), "{word}");
    }
}

#[test]
fn what_differs_is_read_first() {
    let verdicts = [
        "agrees",
        "misprint",
        "agrees",
        "undecided",
        "differs",
        "agrees",
    ];
    let scores: Vec<Score> = verdicts
        .iter()
        .enumerate()
        .map(|(i, v)| pages::score(&format!("s{i}"), v))
        .collect();
    let html = with_scores(scores);
    let order = [
        "1 entry differs</h3>",
        "s4",
        "1 misprint</h3>",
        "s1",
        "1 × undecided</h3>",
        "s3",
        "3 entries agree</h3>",
        "s0",
        "s2",
        "s5",
    ];
    let places: Vec<usize> = order
        .iter()
        .map(|text| {
            place(
                &html,
                &if text.len() == 2 {
                    format!("<tbody id=\"score-{text}\"")
                } else {
                    (*text).to_owned()
                },
            )
        })
        .collect();
    assert!(places.is_sorted(), "{places:?}");
    assert_eq!(
        html.matches("<tbody id=\"score-").count(),
        verdicts.len(),
        "each entry once"
    );
    assert_eq!(
        html.matches("class=\"badge agrees\"").count(),
        3 + 1,
        "on each entry and above"
    );
    assert_eq!(html.matches(" agrees</span>").count(), 3 + 1, "in words");
}

#[test]
fn what_differs_more_is_read_before_what_differs_less() {
    let sized = |id: &str, difference| Score {
        difference,
        ..pages::score(id, "differs")
    };
    let html = with_scores(vec![
        sized("small", Some(1.6e-4)),
        sized("large", Some(-0.0438)),
        sized("claim", None),
        sized("middle", Some(0.003)),
    ]);
    let places = ["claim", "large", "middle", "small"]
        .map(|id| place(&html, &format!("<tbody id=\"score-{id}\"")));
    assert!(places.is_sorted(), "{places:?}");
    for words in ["-4.4 %", "0.30 %", "0.016 %", "Off by</th>"] {
        assert!(html.contains(words), "{words}");
    }
    assert!(!with_scores(vec![sized("claim", None)]).contains("Off by</th>"));
}

#[test]
fn figures_come_first_and_each_leads_to_its_neighbours() {
    let html = pages::plain().html();
    let parts = [
        "id=\"figures\"",
        "id=\"tables\"",
        "id=\"scorecard\"",
        "id=\"provenance\"",
    ];
    assert!(parts.map(|part| place(&html, part)).is_sorted());
    let nav = &html[place(&html, "<nav")..place(&html, "</nav>")];
    let links = [
        "#figures",
        "#fig07",
        "#tables",
        "#scorecard",
        "#verdict-differs",
        "#provenance",
    ];
    assert!(
        links
            .map(|to| place(nav, &format!("href=\"{to}\"")))
            .is_sorted()
    );
    let section = |id: &str| {
        let start = place(&html, &format!("<section class=\"figure\" id=\"{id}\""));
        &html[start..start + html[start..].find("</section>").expect("its end")]
    };
    assert!(section("fig07").contains("<a href=\"#fig10a\">Figure\u{a0}10a →</a>"));
    assert!(!section("fig07").contains("←"));
    assert!(section("fig10a").contains("<a href=\"#fig07\">← Figure\u{a0}7</a>"));
    assert!(!section("fig10a").contains("→"));
    assert!(section("fig07").contains("href=\"#contents\""));
}

#[test]
fn pictures_are_enlarged_without_a_script() {
    let html = pages::plain().html();
    for id in ["fig07", "fig10a"] {
        let zoom = format!("id=\"{id}-zoom\"");
        let at = place(&html, &zoom);
        assert!(html[..at].ends_with("<input class=\"zoom\" type=\"checkbox\" "));
        // The picture right after its box, as the style has it.
        let label = format!("<label class=\"picture\" for=\"{id}-zoom\"");
        let between = &html[at..at + place(&html[at..], &label)];
        assert_eq!(between.matches('>').count(), 1, "{between}");
    }
    assert!(html.contains(".zoom:checked + .picture img"));
}

#[test]
fn verdicts_without_entries_and_columns_without_values_are_left_out() {
    let mut score = pages::score("a", "agrees");
    assert!(with_scores(vec![score.clone()]).contains("Second method</th>"));
    score.second.clear();
    score.note.clear();
    let html = with_scores(vec![score]);
    let body = &html[place(&html, "<body")..];
    for absent in ["Second method", "class=\"note\"", "differ", "misprint"] {
        assert!(!body.contains(absent), "{absent}");
    }
    let empty = Page::default().html();
    for absent in ["<section", "<table", "<dl", "<li>"] {
        assert!(!empty.contains(absent), "{absent}");
    }
}

#[test]
fn symbols_are_typeset_and_names_are_not() {
    assert_eq!(paragraph("at V_H = 2"), "at <var>V</var><sub>H</sub> = 2");
    assert_eq!(
        paragraph("τ_ss(V_sn)."),
        "<var>τ</var><sub>ss</sub>(<var>V</var><sub>sn</sub>)."
    );
    for name in [
        "state_1",
        "slip_rate_1",
        "a_long_name",
        "a_b.csv",
        "_x",
        "x_",
        "2_3",
        "K_critical",
    ] {
        assert_eq!(paragraph(name), name);
    }
}

#[test]
fn numbers_are_not_broken_at_their_exponent() {
    assert_eq!(
        paragraph("0.05 ± 2e-10 off"),
        "0.05 ± <span class=\"unbroken\">2e-10</span> off"
    );
    assert_eq!(paragraph("three-phase e-mail"), "three-phase e-mail");
    let long = format!("1.{}e-10", "0".repeat(40));
    assert_eq!(paragraph(&long), long, "one that fits no phone is");
}

#[test]
fn times_are_said_in_their_unit() {
    let said = |seconds: f64| {
        with_figure(Figure {
            id: "fig01".into(),
            seconds: Some(seconds),
            ..Figure::default()
        })
    };
    for (seconds, words) in [
        (0.004, "less than 0.1 s"),
        (9.94, "9.9 s"),
        (9.96, "10 s"),
        (119.4, "119 s"),
        (119.6, "2 min 0 s"),
        (3725.0, "62 min 5 s"),
    ] {
        assert!(
            said(seconds).contains(&format!("Took\u{a0}{words} of processor time.")),
            "{seconds}"
        );
    }
    for nothing in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(!said(nothing).contains("Took"), "{nothing}");
    }
}

#[test]
fn tables_files_and_manifest_are_complete() {
    let page = pages::plain();
    let html = page.html();
    assert!(html.contains(
        "<th scope=\"col\">resonance</th><th scope=\"col\"><var>V</var><sub>H</sub></th>"
    ));
    assert!(html.contains("<th scope=\"row\">1:2</th><td class=\"value\">0.0993643289</td>"));
    assert!(html.contains("<th scope=\"row\">version</th><td>0.1.0</td>"));
    assert!(html.contains(&format!(
        "1\u{202f}234\u{202f}567</td><td class=\"hash\"><code>{}</code>",
        page.files[0].sha256
    )));
    assert!(attributes(&html, "href").contains(&"table1.csv"));
}

#[test]
fn the_same_page_gives_the_same_bytes() {
    assert_eq!(pages::hostile().html(), pages::hostile().html());
}
