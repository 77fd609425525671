// Pictures of the program: shown without flicker, and large on request, since their small print is made for a page.

import { getBlob } from "./api.js";
import { button, byId, element } from "./dom.js";
import { pathOf } from "./job.js";
import { problemBox } from "./notices.js";
import { isUs } from "./units.js";

/** Words below a picture that the run has drawn, whose units stay as they are; empty where it has none, or these are shown. */
export const unitsOf = async (blob) => (isUs && />[^<]*\b(mm|MPa|kN)\b/.test(await blob.text()) ? "Picture in metric units, as are the files of the run." : "");

/** An image on paper with a button that shows it as large as the window allows. Gives {node, image}. */
export function createPicture(alt) {
  const image = element("img", { alt, hidden: true });
  const enlarge = button("Enlarge", () => {
    const large = byId("picture-large");
    large.src = image.src;
    large.alt = alt;
    byId("picture-dialog").showModal();
  }, { class: "button small", "aria-label": `Enlarge: ${alt}` });
  return { image, node: element("div", { class: "picture" }, element("div", { class: "paper" }, image), enlarge) };
}

/** A picture among the files of a run. */
export function filePicture(job, file, alt, signal) {
  const { node, image } = createPicture(alt);
  getBlob(`${pathOf(job)}/files/${encodeURIComponent(file)}`, signal).then(async (blob) => {
    await showBlob(image, blob);
    node.append(element("p", { class: "hint" }, await unitsOf(blob)));
  })
    .catch((error) => error.name === "AbortError" || node.after(problemBox(error)));
  return node;
}

/** Shows a blob in an image. The old picture stays until the new one is decoded. */
export async function showBlob(image, blob) {
  const address = URL.createObjectURL(blob);
  const next = new Image();
  next.src = address;
  try {
    await next.decode();
  } catch {
    // An SVG without a size cannot be decoded ahead in some browsers; it is shown as it is.
  }
  const before = image.src;
  image.src = address;
  image.hidden = false;
  if (before.startsWith("blob:")) URL.revokeObjectURL(before);
}
