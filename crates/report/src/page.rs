//! One page that needs no network: styles and plots within it, pictures beside it.

use std::fmt::Write;
use std::path::Path;

use crate::colors;
use crate::plot::{Form, Plot};
use crate::sheet::{self, GOALS};
use crate::sweep::{Found, GAIN};
use crate::table::{Table, escaped, significant};

const STYLE: &str = "\
:root{color-scheme:light dark;--paper:#fbfaf7;--ink:#23262b;--soft:#62676f;--line:#dcd9d1;--panel:#f2f0ea;--link:#0f5aa8}\
@media(prefers-color-scheme:dark){:root{--paper:#14171c;--ink:#d8dbe0;--soft:#969ca6;--line:#2c323b;--panel:#1b1f26;--link:#86bdf5}}\
*{box-sizing:border-box}body{margin:0 auto;max-width:66rem;padding:1.2rem 1rem 4rem;background:var(--paper);color:var(--ink);\
font:1rem/1.5 system-ui,sans-serif}h1{font-size:1.7rem;margin:0 0 .3rem}h2{font-size:1.35rem;margin:0 0 .4rem}\
h3{font-size:1.05rem;margin:1.4rem 0 .4rem}p{margin:.3rem 0 .7rem;max-width:48rem}a{color:var(--link)}\
code{background:var(--panel);border:1px solid var(--line);border-radius:4px;padding:0 .3em;font-size:.9em;overflow-wrap:anywhere}\
section{margin-top:2.4rem;border-top:1px solid var(--line);padding-top:1.1rem}.soft{color:var(--soft)}\
.scroll{overflow-x:auto;margin:.4rem 0 .8rem;border:1px solid var(--line);border-radius:6px}\
table{border-collapse:collapse;font-size:.88rem;width:100%}th,td{padding:.28rem .6rem;text-align:left;vertical-align:top}\
th{color:var(--soft);font-weight:600;border-bottom:1px solid var(--line);position:sticky;top:0;background:var(--paper)}\
tbody tr:nth-child(2n){background:var(--panel)}td{white-space:nowrap}td.number,th.number{text-align:right;font-variant-numeric:tabular-nums}\
.plot{display:block;max-width:100%;height:auto}.narrow{display:none}\
@media(max-width:640px){.wide{display:none}.narrow{display:block}body{padding:.8rem .8rem 3rem}}\
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(15rem,1fr));gap:.9rem;margin:.6rem 0}\
figure{margin:0;min-width:0}.pair{display:grid;grid-template-columns:1fr 1fr;gap:3px}.pair img{width:100%}\
img{display:block;max-width:100%;height:auto;border-radius:4px;background:#000}\
figcaption{font-size:.85rem;color:var(--soft);margin-top:.25rem}summary{cursor:pointer;color:var(--link);margin:.5rem 0}\
nav{display:flex;flex-wrap:wrap;gap:.2rem .9rem;margin:.6rem 0}";

/// A whole page around its body.
#[must_use]
pub fn page(title: &str, body: &str) -> String {
    let title = escaped(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/><title>{title}</title>\
         <style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n{body}</body></html>\n"
    )
}

/// A plot in both widths, of which a page shows one.
#[must_use]
pub fn plotted(plot: &Plot) -> String {
    let form = |class: &str, form| format!("<div class=\"{class}\">{}</div>\n", plot.svg(form));
    form("wide", Form::Wide) + &form("narrow", Form::Narrow)
}

/// A table with its title, under a line that opens it; nothing if it is empty.
#[must_use]
pub fn folded(table: &Table) -> String {
    if table.rows.is_empty() {
        return String::new();
    }
    format!("<details><summary>{}</summary>\n{}</details>\n", escaped(table.title), table.html())
}

/// A table with its title; nothing if it is empty.
#[must_use]
pub fn open(table: &Table) -> String {
    if table.rows.is_empty() {
        return String::new();
    }
    format!("<h3>{}</h3>\n{}", escaped(table.title), table.html())
}

/// The page of a sweep in `folder`, where its pictures are.
#[must_use]
pub fn of_sweep(all: &[Found], folder: &Path) -> String {
    let mut body = String::from(
        "<p>Each scene is rendered in many ways. <em>Error</em> is the root of the mean square difference from what \
         infinitely many samples would give, in steps of 1/255 as a display shows them, before they are rounded; two \
         references that know nothing of each other tell it. Seconds are those of one core. Nothing beats a way on the \
         <em>efficient frontier</em> in both.</p>\n",
    );
    body += "<nav>";
    for found in all {
        let name = escaped(&found.name);
        write!(body, "<a href=\"#{name}\">{name}</a>").expect("a string");
    }
    body += "</nav>\n";
    let tables = sheet::tables(all);
    for table in tables.iter().take(3) {
        body += &open(table);
    }
    for found in all {
        body += &scene(found, folder);
    }
    if all.len() > 1 {
        body += "<section><h2>All scenes</h2>\n";
        for table in tables.iter().skip(3) {
            body += &folded(table);
        }
        body += "</section>\n";
    }
    page("Error against run time", &body)
}

fn scene(found: &Found, folder: &Path) -> String {
    let name = escaped(&found.name);
    let (columns, rows) = found.size;
    let mut text = format!(
        "<section id=\"{name}\"><h2>{name}</h2>\n<p class=\"soft\">{}, {columns} × {rows} pixels, {} primitives",
        escaped(&found.path.display().to_string()),
        found.primitives
    );
    if let Some((_, figures)) = found.references.first() {
        let own = significant(figures.number("own"), 2);
        let samples = figures.number("samples");
        write!(text, "; references of {samples} samples each, together off by {own} steps")
            .expect("a string");
    }
    text += ".</p>\n";
    for goal in GOALS {
        if let Some((way, point)) = found.recommended(goal) {
            writeln!(
                text,
                "<p>For an error below {goal}: <code>{}</code>, {} s, error {}.</p>",
                escaped(&way.words()),
                significant(point.seconds, 2),
                significant(point.error, 2)
            )
            .expect("a string");
        }
    }
    if !found.ways.is_empty() {
        text += &plotted(&found.plot());
    }
    text += &pictures(found, folder);
    for table in sheet::tables(std::slice::from_ref(found)).iter().skip(3) {
        text += &folded(table);
    }
    text + "</section>\n"
}

/// The picture by ways on the frontier, each with what it is off by, and in few colours.
fn pictures(found: &Found, folder: &Path) -> String {
    let image = |file: &str| {
        let path = format!("pictures/{}/{file}", found.name);
        folder.join(&path).exists().then(|| {
            let (columns, rows) = found.size;
            let path = escaped(&path);
            format!("<img src=\"{path}\" width=\"{columns}\" height=\"{rows}\" alt=\"{path}\" loading=\"lazy\"/>")
        })
    };
    let mut figures = String::new();
    let mut figure = |images: &[Option<String>], caption: &str| {
        let shown: String = images.iter().flatten().map(String::as_str).collect();
        let class = if images.len() > 1 { " class=\"pair\"" } else { "" };
        if !shown.is_empty() {
            writeln!(
                figures,
                "<figure><div{class}>{shown}</div><figcaption>{caption}</figcaption></figure>"
            )
            .expect("a string");
        }
    };
    figure(&[image("reference-box.png")], "both references together");
    for way in found.efficient() {
        let known = found.ways.iter().find(|(other, _)| other == way);
        let [seconds, error] = ["seconds", "error"]
            .map(|name| significant(known.map_or(f64::NAN, |(_, f)| f.number(name)), 2));
        let images =
            [image(&format!("{}.png", way.file())), image(&format!("{}-off.png", way.file()))];
        let words = escaped(&way.words());
        figure(
            &images,
            &format!("{words}: {error} steps, {seconds} s; beside it the difference × {GAIN}"),
        );
    }
    let best = |of: fn(&colors::Way) -> bool| found.colors.iter().find(|(way, _)| of(way));
    let dithered = best(|way| way.dither.strength > 0.0 && way.metric == ilut::Metric::Oklab);
    let plain = best(|way| way.method == ilut::Method::Best && way.metric == ilut::Metric::Rgb);
    for (way, known) in [plain, dithered].into_iter().flatten() {
        let off = significant(known.number("rms_rgb"), 2);
        let words = escaped(&way.words());
        figure(
            &[image(&format!("{}.png", way.file()))],
            &format!("256 colours, {words}: off by {off}"),
        );
    }
    if figures.is_empty() {
        return figures;
    }
    format!("<div class=\"pictures\">\n{figures}</div>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_well_formed_and_asks_for_nothing() {
        let found = Found { name: "a<b".into(), path: "x & y.sdl".into(), ..Found::default() };
        let html = of_sweep(&[found, Found::default()], Path::new("none"));
        let body = html.strip_prefix("<!DOCTYPE html>\n").unwrap();
        let parsed = roxmltree::Document::parse(body);
        assert!(parsed.is_ok(), "{parsed:?}: {html}");
        assert!(!html.contains("http") && html.contains("x &amp; y.sdl"), "{html}");
    }
}
