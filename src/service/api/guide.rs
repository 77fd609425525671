//! The guide at `/guide`, its pages as HTML.

use axum::extract::Path;
use axum::response::Html;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, html::push_html};

use crate::problem::{Answer, Problem};
use perilife_runner::guide;

/// The index.
pub async fn index() -> Answer<Html<String>> {
    html("index", "", "guide/")
}

/// A page.
pub async fn page(Path(name): Path<String>) -> Answer<Html<String>> {
    html(&name, "../", "")
}

/// A page in the frame of the service; `root` and `guide` are relative addresses, so that a proxy may add a prefix.
fn html(name: &str, root: &str, guide: &str) -> Answer<Html<String>> {
    let text = guide::page(name).ok_or_else(|| Problem::not_found("page of the guide"))?;
    let title = text.lines().next().unwrap_or_default().trim_start_matches("# ");
    let mut body = String::new();
    push_html(&mut body, Parser::new_ext(text, Options::ENABLE_TABLES).map(|event| served(event, guide)));
    // What scrolls by itself on a narrow window must be reachable by keyboard.
    let body = body.replace("<pre>", "<pre tabindex=\"0\">").replace("<table>", "<table tabindex=\"0\">");
    Ok(Html(format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{title} · perilife</title><link rel=\"icon\" href=\"{root}icon.svg\" type=\"image/svg+xml\"><link rel=\"stylesheet\" href=\"{root}style.css\">\
         <link rel=\"stylesheet\" href=\"{root}guide.css\"><script src=\"{root}theme.js\"></script></head><body><header class=\"top\"><div class=\"top-inner\">\
         <span class=\"brand\">perilife</span><nav aria-label=\"Main\"><a href=\"{root}./\">Service</a><a href=\"{guide}index\">Guide</a>\
         <a href=\"{root}docs/\">API</a></nav><div class=\"theme\"><button type=\"button\" class=\"button bare\" id=\"theme\">Light / dark</button>\
         </div></div></header><main class=\"guide\">{body}</main></body></html>"
    )))
}

/// Links to pages of the guide are those of the service.
fn served<'a>(event: Event<'a>, guide: &str) -> Event<'a> {
    let Event::Start(Tag::Link { link_type, dest_url, title, id }) = event else { return event };
    let page = dest_url.strip_suffix(".md").filter(|page| guide::page(page).is_some());
    let dest_url = page.map_or_else(|| dest_url.clone(), |page| CowStr::from(format!("{guide}{page}")));
    Event::Start(Tag::Link { link_type, dest_url, title, id })
}
