//! `chart.html`: the picture in a page of its own; a point that is pointed at or has the focus shows its settings and the command
//! that repeats it, and everything stands in a table below.

use serde_json::{Map, Value, json};

use super::{Origin, digits, escaped, seconds};
use crate::chart::{Chart, Point};

const STYLE: &str = "body{font:15px 'IBM Plex Sans','Segoe UI',Helvetica,Arial,sans-serif;color:#1c2430;margin:24px;max-width:1340px}\
svg{width:100%;height:auto}.p{cursor:pointer;outline:none}.p:focus path,.p:hover path{stroke-width:3}\
#told{position:sticky;bottom:0;background:#f4f6f9;border:1px solid #cfd6df;border-radius:8px;padding:8px 14px;min-height:64px}\
#told code{font-size:13px}table{border-collapse:collapse;font-size:13px;margin-top:16px}th,td{padding:3px 10px;text-align:left;\
border-bottom:1px solid #e3e7ec}td.n{text-align:right;font-variant-numeric:tabular-nums}";

const SCRIPT: &str = "const D=JSON.parse(document.getElementById('data').textContent),T=document.getElementById('told');\
for(const g of document.querySelectorAll('.p')){g.setAttribute('tabindex','0');g.setAttribute('role','button');\
const d=D[g.dataset.at];if(!d)continue;g.setAttribute('aria-label',d.title);\
const show=()=>{T.replaceChildren();const b=document.createElement('b');b.textContent=d.title;const p=document.createElement('div');\
p.textContent=d.text;const c=document.createElement('code');c.textContent=d.command;T.append(b,p,c)};\
g.addEventListener('mouseenter',show);g.addEventListener('focus',show);g.addEventListener('click',show)}";

/// The page.
pub fn page(chart: &Chart, origin: &Origin, picture: &str) -> String {
    let mut data = Map::new();
    for point in &chart.points {
        data.insert(format!("{}/{}", point.scene.name, point.choice.name()), told(point));
    }
    // `</` would end the element that holds it.
    let data = Value::Object(data).to_string().replace("</", "<\\/");
    let rows: String = chart.points.iter().map(row).collect();
    let footer = escaped(&origin.footer(chart).replace('`', ""));
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>perilife: speed and accuracy</title>\n<style>{STYLE}</style></head>\n<body>\n{picture}\
         <div id=\"told\" aria-live=\"polite\">Point at a mark, or move to it with the tab key: its settings and the command that repeats it.</div>\n\
         <table><thead><tr><th>scene</th><th>choice</th><th>error, %</th><th>path, mm</th><th>time</th><th>over reference</th><th>runs</th>\
         <th>memory, MB</th><th>on the front</th><th>status</th></tr></thead><tbody>\n{rows}</tbody></table>\n<p>{footer}</p>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n<script>{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

fn told(point: &Point) -> Value {
    let title = format!("{}: {}", point.scene.about, point.choice.name());
    let text = match &point.run {
        Some(run) => format!(
            "error {} % of {} (truth: {}); {}, runs {}, spread {} %; {} points, {} solves, {} MB",
            digits(run.error_percent),
            point.scene.quantity,
            point.scene.truth,
            seconds(point.wall_s().unwrap_or(f64::NAN)),
            point.walls.len(),
            digits(point.spread_percent().unwrap_or(f64::NAN)),
            run.points,
            run.solves,
            digits(run.memory_mb)
        ),
        None => format!("{}: {}", point.status, point.reason),
    };
    json!({ "title": title, "text": text, "command": point.command() })
}

fn row(point: &Point) -> String {
    let run = point.run.as_ref();
    let number = |value: Option<f64>| value.map_or_else(String::new, digits);
    format!(
        "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td title=\"{}\">{}</td></tr>\n",
        point.scene.name,
        escaped(&point.choice.name()),
        number(run.map(|run| run.error_percent)),
        number(run.and_then(|run| run.path_rms_mm)),
        point.wall_s().map_or_else(String::new, seconds),
        number(point.time_ratio()),
        point.walls.len(),
        number(run.map(|run| run.memory_mb)),
        if point.is_on_front { "yes" } else { "" },
        escaped(&point.reason),
        point.status
    )
}
