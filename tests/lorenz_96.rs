//! Systems from formulas in more variables than most: Lorenz's ring of 1996 with 12, 40 and 100, against series in 50 digits.

use crate::common::data;
use std::borrow::Cow;
use twinslip::field::Vector;
use twinslip::integrate::{AnyField, AnyIntegrator, Choice, MAX_STEPS, Tolerances};
use twinslip::model::TextSystem;
use twinslip_tasks::scene::{TextModel, TextOptions};

fn ring(count: usize) -> TextSystem {
    let names: Vec<String> = (0..count).map(|i| format!("x{i}")).collect();
    let mut text = format!("name = \"ring\"\nstates = {names:?}\n[parameters]\nF = 8.0\n[rates]\n");
    for i in 0..count {
        let of = |by: usize| &names[(i + by) % count];
        let (next, before, last) = (of(1), of(count - 2), of(count - 1));
        text += &format!("x{i} = \"({next} - {before})*{last} - x{i} + F\"\n");
    }
    let options = TextOptions {
        system: Some(text.into()),
        ..TextOptions::default()
    };
    let model = TextModel::named(&options).expect("a good file");
    model.expect("a system").system
}

#[test]
fn rings_of_a_dozen_to_a_hundred_come_where_their_series_do() {
    let all = data("lorenz_96.json");
    for count in [12, 40, 100] {
        let system = ring(count);
        let field = AnyField::of_text(Cow::Borrowed(&system)).expect("a field");
        assert_eq!(field.dimension(), count);
        let start = Vector::from_fn(count, |i, _| 8.0 + ((7 * i % 13) as f64 - 6.0) / 64.0);
        let known = all[count.to_string()].as_array().expect("a list").iter();
        let known: Vec<f64> = known
            .map(|x| x.as_str().unwrap().parse().unwrap())
            .collect();
        for method in ["taylor", "radau", "rodas5p"] {
            let tolerances = Tolerances::equal(1e-12).expect("tolerances");
            let choice = Choice::named(method).expect("a method");
            let mut by = AnyIntegrator::new(choice, tolerances, MAX_STEPS).expect("a method");
            let end = by.flow(&field, (0.0, 2.0), &start, None).expect("a run");
            // The ring is chaotic: what steps err grows a hundredfold.
            let bar = if method == "rodas5p" { 1e-7 } else { 1e-9 };
            let off = (end - Vector::from_column_slice(&known)).amax();
            assert!(off < bar, "{count}, {method}: {off}");
        }
    }
}
