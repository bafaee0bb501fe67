//! An HTML page that is one file: styles, script and pictures are in it, and nothing is fetched.

use super::chart::Chart;
use super::look::style;
use super::markup::{escape, png_uri, put};
use crate::render::{Film, Picture, encode_picture};

/// Widths at which charts are drawn, for desks and for phones.
const WIDE: f64 = 900.0;
const NARROW: f64 = 360.0;

/// A page in the making.
pub struct Page {
    body: String,
    tables: usize,
}

/// A cell of a table.
pub struct Cell {
    /// Its content, escaped already.
    html: String,
    class: &'static str,
    /// What the column is sorted by, if not by the content.
    value: Option<f64>,
}

impl Cell {
    /// Text, to the left.
    #[must_use]
    pub fn text(text: &str) -> Self {
        Self { html: escape(text), class: "text", value: None }
    }

    /// Text in lines that may break, to the left.
    #[must_use]
    pub fn wrapped(text: &str) -> Self {
        Self { class: "text wrap", ..Self::text(text) }
    }

    /// Text whose letters are all of one width.
    #[must_use]
    pub fn code(text: &str) -> Self {
        Self { class: "code", ..Self::text(text) }
    }

    /// A number as it is written, and as it is sorted.
    #[must_use]
    pub fn number(written: &str, value: f64) -> Self {
        Self { html: escape(written), class: "", value: Some(value) }
    }

    /// Text after a mark of a chart.
    #[must_use]
    pub fn marked(look: super::Look, text: &str) -> Self {
        let mark = look.svg(8.0, 8.0, "");
        let html = format!(
            "<svg class=\"chart\" viewBox=\"0 0 16 16\" aria-hidden=\"true\">{mark}</svg>{}",
            escape(text)
        );
        Self { html, class: "text", value: None }
    }
}

/// A picture of a gallery.
pub struct Shown<'a> {
    /// On its button.
    pub name: &'a str,
    /// Below it.
    pub caption: &'a str,
    /// The picture itself.
    pub film: &'a Film,
    /// The factor from film to picture.
    pub exposure: f32,
}

impl Page {
    /// A page with nothing but a heading and what stands below it.
    #[must_use]
    pub fn new(title: &str, lead: &str) -> Self {
        let title = escape(title);
        let mut body = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" \
             content=\"width=device-width, \
             initial-scale=1\"/>\n<title>{title}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n",
            include_str!("page.css"),
            style()
        );
        put(
            &mut body,
            format_args!(
                "<header>\n<h1>{title}</h1>\n<p>{}</p>\n</header>\n<main>\n",
                escape(lead)
            ),
        );
        Self { body, tables: 0 }
    }

    /// A heading; what follows belongs to it.
    pub fn heading(&mut self, text: &str) {
        put(&mut self.body, format_args!("<h2>{}</h2>\n", escape(text)));
    }

    /// A heading below another.
    pub fn subheading(&mut self, text: &str) {
        put(&mut self.body, format_args!("<h3>{}</h3>\n", escape(text)));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        put(&mut self.body, format_args!("<p>{}</p>\n", escape(text)));
    }

    /// A paragraph with a command line.
    pub fn command(&mut self, before: &str, command: &str) {
        put(
            &mut self.body,
            format_args!("<p>{} <code>{}</code></p>\n", escape(before), escape(command)),
        );
    }

    /// A list.
    pub fn list(&mut self, items: &[String]) {
        self.body += "<ul class=\"findings\">\n";
        for item in items {
            put(&mut self.body, format_args!("<li>{}</li>\n", escape(item)));
        }
        self.body += "</ul>\n";
    }

    /// A chart, drawn once for desks and once for phones.
    pub fn chart(&mut self, chart: &Chart) {
        put(
            &mut self.body,
            format_args!(
                "<figure>\n<div class=\"wide\">{}</div>\n<div class=\"narrow\">{}</div>\n</figure>\n",
                chart.svg(WIDE),
                chart.svg(NARROW)
            ),
        );
    }

    /// A table that sorts; with a filter of its first column if it is to have one. Rows that are marked
    /// stand out.
    pub fn table(&mut self, columns: &[&str], rows: &[(bool, Vec<Cell>)], filter: Option<&str>) {
        self.tables += 1;
        let id = format!("table-{}", self.tables);
        if let Some(filter) = filter {
            put(
                &mut self.body,
                format_args!(
                    "<label class=\"filter\" data-table=\"{id}\" hidden=\"\">{} <input \
                     type=\"search\"/></label>\n",
                    escape(filter)
                ),
            );
        }
        put(
            &mut self.body,
            format_args!(
                "<div class=\"scroll\" tabindex=\"0\">\n<table class=\"sortable\" id=\"{id}\">\n<thead>\n<tr>"
            ),
        );
        let classes = rows.first().map_or(&[][..], |(_, cells)| cells);
        for (place, column) in columns.iter().enumerate() {
            let is_text = classes.get(place).is_some_and(|cell| !cell.class.is_empty());
            let class = if is_text { "text" } else { "" };
            put(
                &mut self.body,
                format_args!("<th scope=\"col\" class=\"{class}\">{}</th>", escape(column)),
            );
        }
        self.body += "</tr>\n</thead>\n<tbody>\n";
        for (is_marked, cells) in rows {
            self.body += if *is_marked { "<tr class=\"front\">" } else { "<tr>" };
            for Cell { html, class, value } in cells {
                let value =
                    value.map_or_else(String::new, |value| format!(" data-value=\"{value}\""));
                put(&mut self.body, format_args!("<td class=\"{class}\"{value}>{html}</td>"));
            }
            self.body += "</tr>\n";
        }
        self.body += "</tbody>\n</table>\n</div>\n";
    }

    /// Pictures to flip between; the first is what the others are held against.
    pub fn gallery(&mut self, pictures: &[Shown]) {
        self.body += "<div class=\"gallery\">\n<div class=\"tabs\"></div>\n";
        for Shown { name, caption, film, exposure } in pictures {
            let uri = png_uri(&encode_picture(film, *exposure, Picture::Png8));
            let (name, caption) = (escape(name), escape(caption));
            put(
                &mut self.body,
                format_args!(
                    "<figure data-name=\"{name}\"><img src=\"{uri}\" alt=\"{name}\" width=\"{}\" \
                     height=\"{}\"/><figcaption>{caption}</figcaption></figure>\n",
                    film.width(),
                    film.height()
                ),
            );
        }
        self.body += "</div>\n";
    }

    /// The whole page.
    #[must_use]
    pub fn finish(self) -> String {
        let script = include_str!("page.js");
        format!("{}</main>\n<script>\n{script}</script>\n</body>\n</html>\n", self.body)
    }
}
