#include "reference/compare/comparison_page.h"

#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include "reference/compare/comparison_table.h"
#include "reference/compare/frontier.h"
#include "reference/compare/heat_map.h"

namespace eikonal::reference {
namespace {

constexpr const char* kStyle = R"(
:root{--ink:#23272c;--soft:#6b7178;--line:#e2dfd8;--paper:#fbfaf7;--card:#fff;--mark:#b3401e}
@media (prefers-color-scheme:dark){:root{--ink:#e8e6e1;--soft:#9a9fa6;--line:#33363b;--paper:#17191c;--card:#1f2226;--mark:#e8804f}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:17px/1.6 Charter,'Bitstream Charter','Iowan Old Style','Source Serif 4',Georgia,serif}
main{max-width:1200px;margin:0 auto;padding:56px 28px 96px}
h1{font-size:40px;line-height:1.15;letter-spacing:-.015em;font-weight:600;margin:0 0 8px}
h2{font-size:24px;font-weight:600;letter-spacing:-.01em;margin:64px 0 14px}
p{margin:0 0 14px;max-width:68ch}
.lead{font-size:20px;color:var(--soft);margin-bottom:34px}
dl,table,.controls,figcaption,.ends{font-family:ui-sans-serif,system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;font-variant-numeric:tabular-nums}
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 22px;font-size:15px;margin:0;border-top:1px solid var(--line);padding-top:18px}
dt{color:var(--soft)}
dd{margin:0}
.controls{display:flex;flex-wrap:wrap;gap:10px 26px;align-items:center;font-size:15px;margin-bottom:14px}
select{font:inherit;color:inherit;background:var(--card);border:1px solid var(--line);border-radius:6px;padding:5px 9px;margin-left:8px}
.slider{position:relative;overflow:hidden;border-radius:6px;background:#000;touch-action:pan-y;cursor:ew-resize}
.slider img{display:block;width:100%;height:100%;object-fit:cover;object-position:top;image-rendering:pixelated;user-select:none;pointer-events:none}
.slider .over{position:absolute;inset:0;clip-path:inset(0 calc(100% - var(--at)) 0 0)}
.slider .bar{position:absolute;top:0;bottom:0;left:var(--at);width:2px;margin-left:-1px;background:#fff;box-shadow:0 0 0 1px rgba(0,0,0,.35);pointer-events:none}
.slider .bar:after{content:'';position:absolute;top:50%;left:50%;width:30px;height:30px;margin:-15px;border-radius:50%;background:#fff;box-shadow:0 1px 5px rgba(0,0,0,.45)}
.slider input{position:absolute;inset:0;width:100%;height:100%;margin:0;opacity:0;cursor:ew-resize}
.slider:focus-within{outline:3px solid var(--mark);outline-offset:3px}
.wide{overflow-x:auto}
table{border-collapse:collapse;font-size:13.5px;line-height:1.35;width:100%}
th,td{text-align:right;padding:7px 7px;white-space:nowrap;border-bottom:1px solid var(--line)}
th{font-weight:500;color:var(--soft)}
th:first-child,td:first-child{text-align:left;padding-left:0}
.groups th{text-align:left;white-space:normal;vertical-align:bottom;color:var(--ink);border-bottom:0;padding-bottom:0}
.first{border-left:1px solid var(--line)}
.best td:first-child{color:var(--mark);font-weight:600}
.plot{display:block;width:100%;height:auto;border:1px solid var(--line);border-radius:6px}
button{font:inherit;color:inherit;background:var(--card);border:1px solid var(--line);border-radius:6px;padding:5px 14px;cursor:pointer}
.frame{display:flex;gap:10px;align-items:center}
.frame output{min-width:4ch}
.pictures[hidden]{display:none}
.pictures{display:grid;grid-template-columns:repeat(auto-fill,minmax(300px,1fr));gap:26px 22px}
figure{margin:0}
figure .crop{overflow:hidden;border-radius:4px;background:#000}
figure img{display:block;width:100%;height:100%;object-fit:cover;object-position:top;image-rendering:pixelated}
figcaption{font-size:14px;color:var(--soft);padding-top:6px}
.scale{height:8px;border-radius:2px;margin-top:8px}
.ends{display:flex;justify-content:space-between;font-size:12.5px;color:var(--soft)}
summary{cursor:pointer;font-size:16px;margin:18px 0}
li{margin-bottom:6px}
)";

constexpr const char* kScript = R"(
const slider = document.querySelector('.slider'), range = slider.querySelector('input');
const frames = [...document.querySelectorAll('.pictures')], choices = [...document.querySelectorAll('.frame input')];
const sides = [['left', '.over img'], ['right', '.under img']];
let at = 0, playing;
function show() {
  slider.style.setProperty('--at', range.value / 10 + '%');
  frames.forEach((frame, i) => frame.hidden = i != at);
  for (const choice of choices) {
    choice.value = at;
    choice.nextElementSibling.value = frames[at].dataset.frame;
  }
  for (const [name, place] of sides) {
    const wanted = document.getElementById(name).value;
    const from = [...frames[at].querySelectorAll('img')].find(img => img.alt == wanted);
    const to = slider.querySelector(place);
    to.style.visibility = from ? 'visible' : 'hidden';
    if (from) to.src = from.src;
    to.alt = wanted;
  }
}
range.addEventListener('input', show);
for (const [name] of sides) document.getElementById(name).addEventListener('change', show);
for (const choice of choices) choice.addEventListener('input', () => { at = Number(choice.value); show(); });
for (const button of document.querySelectorAll('.frame button')) button.addEventListener('click', () => {
  if (playing) clearInterval(playing);
  playing = playing ? 0 : setInterval(() => { at = (at + 1) % frames.length; show(); }, 200);
  for (const b of document.querySelectorAll('.frame button')) b.textContent = playing ? 'stop' : 'play';
});
show();
)";

std::string source(const PagePicture& picture) {
    return "data:image/png;base64," + OIIO::Strutil::base64_encode(picture.png);
}

std::string table(const Comparison& c, bool brief) {
    std::vector<Column> list = columns(c);
    if (brief) std::erase_if(list, [](const Column& column) { return !column.brief; });
    const auto first = [&](std::size_t i) { return i == 0 || list[i].group != list[i - 1].group; };
    const auto side = [&](std::size_t i) { return first(i) ? " class=\"first\"" : ""; };
    std::string groups, headings, rows;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (first(i)) {
            std::size_t end = i + 1;
            while (end < list.size() && !first(end)) ++end;
            groups += fmt::format("<th class=\"first\" colspan=\"{}\">{}</th>", end - i, heading_of(list[i].group));
        }
        headings += fmt::format("<th{}>{}</th>", side(i), list[i].heading);
    }
    const std::vector<std::size_t> best = efficient(c);
    for (std::size_t m = 0; m < c.models.size(); ++m) {
        const ModelResult& model = c.models[m];
        if (!model.applies()) continue;
        const bool is_best = std::find(best.begin(), best.end(), m) != best.end();
        rows += fmt::format("<tr{}><td>{}</td>", is_best ? " class=\"best\"" : "", row_name(model));
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto value = list[i].value(c, model);
            rows += fmt::format("<td{}>{}</td>", side(i), value ? readable(*value) : "–");
        }
        rows += "</tr>\n";
    }
    return fmt::format(
        "<div class=\"wide\"><table>\n<thead><tr class=\"groups\"><th></th>{}</tr>\n<tr><th>model</th>{}</tr></thead>\n"
        "<tbody>\n{}</tbody>\n</table></div>\n",
        groups, headings, rows);
}

std::string choice(const std::vector<PagePicture>& pictures, std::string_view name, std::string_view label,
                   std::size_t chosen) {
    std::string options;
    for (std::size_t i = 0; i < pictures.size(); ++i)
        options += fmt::format("<option{}>{}</option>", i == chosen ? " selected=\"selected\"" : "",
                               escaped(pictures[i].label));
    return fmt::format("<label>{}<select id=\"{}\">{}</select></label>\n", label, name, options);
}

/// The controls that choose the frame. Empty if there is only one.
std::string frame_choice(const std::vector<PageFrame>& frames) {
    if (frames.size() < 2) return "";
    return fmt::format(
        "<span class=\"frame\">frame <input type=\"range\" min=\"0\" max=\"{}\" value=\"0\" aria-label=\"frame\" />"
        "<output>{}</output><button type=\"button\">play</button></span>\n",
        frames.size() - 1, frames.front().number);
}

std::string slider(const Comparison& c, const std::vector<PageFrame>& frames) {
    const std::vector<PagePicture>& pictures = frames.back().pictures;  // the last frame has all pictures
    std::size_t right = std::min<std::size_t>(1, pictures.size() - 1);
    for (std::size_t i = 0; i < pictures.size(); ++i)
        if (pictures[i].is_default) right = i;
    return fmt::format(
        "<div class=\"controls\">\n{}{}{}</div>\n"
        "<div class=\"slider\" style=\"aspect-ratio:{}/{};--at:50%\">\n"
        "<div class=\"under\" style=\"height:100%\"><img alt=\"\" /></div><div class=\"over\"><img alt=\"\" /></div>"
        "<div class=\"bar\"></div>\n"
        "<input type=\"range\" min=\"0\" max=\"1000\" value=\"500\" aria-label=\"how much of the left picture is "
        "seen\" />\n</div>\n",
        choice(pictures, "left", "left", 0), choice(pictures, "right", "right", right), frame_choice(frames), c.width,
        c.height);
}

std::string figure(const Comparison& c, const PagePicture& picture) {
    std::string scale;
    if (picture.scale_end > 0)
        scale = fmt::format(
            "<div class=\"scale\" style=\"background:{}\"></div><div class=\"ends\"><span>0</span><span>{:.4g}</span>"
            "<span>{:.4g} px</span></div>",
            heat_gradient(), picture.scale_end / 2, picture.scale_end);
    return fmt::format(
        "<figure><div class=\"crop\" style=\"aspect-ratio:{}/{}\"><img alt=\"{}\" src=\"{}\" /></div>"
        "{}<figcaption>{}</figcaption></figure>\n",
        c.width, c.height, escaped(picture.label), source(picture), scale, escaped(picture.label));
}

/// Every frame's pictures. All but those of the first frame are hidden.
std::string gallery(const Comparison& c, const std::vector<PageFrame>& frames) {
    std::string list;
    for (const PageFrame& frame : frames) {
        list += fmt::format("<div class=\"pictures\" data-frame=\"{}\"{}>\n", frame.number,
                            &frame == &frames.front() ? "" : " hidden=\"hidden\"");
        for (const PagePicture& picture : frame.pictures) list += figure(c, picture);
        list += "</div>\n";
    }
    return list;
}

std::string refusals(const Comparison& c) {
    std::string items;
    for (const ModelResult& model : c.models)
        if (!model.applies()) items += fmt::format("<li><b>{}</b>: {}</li>\n", model.name, escaped(model.refusal));
    if (items.empty()) return "";
    return "<h2>Models that do not apply</h2>\n<ul>\n" + items + "</ul>\n";
}

std::string method(const Comparison& c) {
    return fmt::format(
        "<h2>How it was measured</h2>\n"
        "<p>The plate is rendered with straight rays, the truth with bent ones. Each model’s map is made from the "
        "plate’s depth and compared with the displacement that the tracer finds at every pixel’s centre. A silhouette "
        "is "
        "a jump of depth by more than {:g} %, and what lies within {} px of it, or within its true "
        "displacement if that is more.</p>\n"
        "<p>Pictures are compared as shown: PSNR and SSIM of sRGB codes; <i>butteraugli</i> is what an eye "
        "notices, by libjxl (its {:g}-norm; from about 1 on a close look tells the pictures apart). Times are this "
        "machine’s wall times on all threads; "
        "<i>times faster</i> is against "
        "the "
        "{} tracer’s picture with {} rays a pixel, in the same run. Memory is by how "
        "much "
        "the resident memory of the process grew at its highest while a model’s shot and first map were made.</p>\n"
        "<p>Rows in colour are the efficient ones: no other model, nor the plate itself, is both quicker and more "
        "exact (p95).{}</p>\n",
        100 * kSilhouetteJump, kSilhouetteReach, kButteraugliNorm, c.integrator, c.samples,
        c.over_time() ? " <i>From frame to frame</i> is the error of each pixel’s change of displacement between "
                        "consecutive frames: flicker, which the eye sees first."
                      : "");
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

bool on_page(std::size_t i, std::size_t count) {
    if (count <= kMostPageFrames) return true;
    // Frame k of the page is the shot's frame k (count - 1)/(kMostPageFrames - 1).
    const std::size_t k = (i * (kMostPageFrames - 1) + count - 2) / (count - 1);
    return k * (count - 1) / (kMostPageFrames - 1) == i;
}

std::string comparison_page(const Comparison& c, const std::vector<PageFrame>& frames) {
    std::string list;
    for (const Fact& fact : facts(c))
        list += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escaped(fact.label), escaped(fact.text));
    const std::string name = escaped(c.scene);
    const std::string number = frames.size() == 1 ? fmt::format(", frame {}", frames.front().number) : "";
    const std::string again =
        frames.size() == 1 ? "" : "<div class=\"controls\">\n" + frame_choice(frames) + "</div>\n";
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n<meta charset=\"utf-8\" "
        "/>\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n<title>{0}: warp against "
        "tracer</title>\n"
        "<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n"
        "<p class=\"lead\">Heat shimmer by every model that this scene suits, held against true bent rays.</p>\n"
        "<dl>\n{2}</dl>\n<h2>Before and after{3}</h2>\n{4}<h2>Error and cost</h2>\n{5}"
        "<h2>What an error costs</h2>\n{6}<h2>Pictures{3}</h2>\n{7}{8}{9}"
        "{10}<details><summary>All "
        "figures</summary>\n{11}</details>\n</main>\n<script>{12}</script>\n</body>\n</html>\n",
        name, kStyle, list, number, slider(c, frames), table(c, true), frontier_svg(c), again, gallery(c, frames),
        refusals(c), method(c), table(c, false), kScript);
}

}  // namespace eikonal::reference
