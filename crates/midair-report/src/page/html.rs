//! A page as HTML.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::model::{Block, Cell, Figure, Image, Page, Table};

pub(super) const STYLE: &str = include_str!("style.css");

/// Text as the content of an element or of a quoted attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Characters that HTML has no way to hold.
            '\0'..='\x08' | '\x0b' | '\x0c' | '\x0e'..='\x1f' => out.push('\u{fffd}'),
            other => out.push(other),
        }
    }
    out
}

pub(super) fn document(page: &Page) -> String {
    let title = escaped(&page.title);
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n"
    );
    if !page.lead.is_empty() {
        push(&mut out, format_args!("<p class=\"lead\">{}</p>\n", escaped(&page.lead)));
    }
    out.push_str("</header>\n<main>\n");
    if !page.summary.is_empty() {
        out.push_str("<dl>\n");
        for row in &page.summary {
            let (label, value) = (escaped(&row.label), escaped(&row.value));
            push(&mut out, format_args!("<div><dt>{label}</dt><dd class=\"value\">{value}</dd>"));
            if !row.note.is_empty() {
                push(&mut out, format_args!("<dd class=\"note\">{}</dd>", escaped(&row.note)));
            }
            out.push_str("</div>\n");
        }
        out.push_str("</dl>\n");
    }
    for section in &page.sections {
        push(&mut out, format_args!("<section>\n<h2>{}</h2>\n", escaped(&section.heading)));
        section.blocks.iter().for_each(|item| block(&mut out, item));
        out.push_str("</section>\n");
    }
    out.push_str("</main>\n");
    if !page.colophon.is_empty() {
        push(&mut out, format_args!("<footer>{}</footer>\n", escaped(&page.colophon)));
    }
    out.push_str("</body>\n</html>\n");
    out
}

/// Appends formatted text; a String takes all of it.
fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = out.write_fmt(text);
}

fn block(out: &mut String, block: &Block) {
    match block {
        Block::Text(text) => push(out, format_args!("<p>{}</p>\n", escaped(text))),
        Block::Figures(figures) => {
            out.push_str("<div class=\"figures\">\n");
            figures.iter().for_each(|item| figure(out, item));
            out.push_str("</div>\n");
        }
        Block::Table(item) => table(out, item),
        Block::Notes(notes) => {
            out.push_str("<ul>\n");
            for note in notes {
                push(out, format_args!("<li>{}</li>\n", escaped(note)));
            }
            out.push_str("</ul>\n");
        }
    }
}

fn figure(out: &mut String, figure: &Figure) {
    let caption = escaped(&figure.caption);
    out.push_str("<figure>");
    match &figure.image {
        Image::Png(bytes) => {
            let data = STANDARD.encode(bytes);
            push(
                out,
                format_args!("<img src=\"data:image/png;base64,{data}\" alt=\"{caption}\"/>"),
            );
        }
        Image::Line(chart) => out.push_str(&chart.to_svg()),
        Image::Vectors(chart) => out.push_str(&chart.to_svg()),
    }
    push(out, format_args!("<figcaption>{caption}</figcaption></figure>\n"));
}

fn table(out: &mut String, table: &Table) {
    // The frame scrolls where the screen is narrower than the table: reachable by keyboard.
    out.push_str("<div class=\"table\" tabindex=\"0\">\n<table>\n");
    if !table.caption.is_empty() {
        push(out, format_args!("<caption>{}</caption>\n", escaped(&table.caption)));
    }
    out.push_str("<thead>\n");
    for row in &table.head {
        out.push_str("<tr>");
        for (text, span) in row {
            let text = escaped(text);
            match span {
                0 | 1 => push(out, format_args!("<th scope=\"col\">{text}</th>")),
                span => push(
                    out,
                    format_args!(
                        "<th scope=\"colgroup\" class=\"span\" colspan=\"{span}\">{text}</th>"
                    ),
                ),
            }
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</thead>\n<tbody>\n");
    table.rows.iter().for_each(|row| cells(out, row));
    out.push_str("</tbody>\n");
    if !table.foot.is_empty() {
        out.push_str("<tfoot>\n");
        table.foot.iter().for_each(|row| cells(out, row));
        out.push_str("</tfoot>\n");
    }
    out.push_str("</table>\n</div>\n");
}

fn cells(out: &mut String, row: &[Cell]) {
    out.push_str("<tr>");
    for (column, cell) in row.iter().enumerate() {
        let text = escaped(&cell.text);
        match (column, cell.best) {
            (0, _) => push(out, format_args!("<th scope=\"row\">{text}</th>")),
            (_, true) => push(out, format_args!("<td><b>{text}</b></td>")),
            (_, false) => push(out, format_args!("<td>{text}</td>")),
        }
    }
    out.push_str("</tr>\n");
}
