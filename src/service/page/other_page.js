// Page of a run that is one of a command as a whole (scene, sweep, stress intensity factors): its pictures and files.

import { getBlob, getJson } from "./api.js";
import { warningList } from "./check.js";
import { element, section, show, showPage } from "./dom.js";
import { createJobHead, downloadList, inputText, pathOf, showAtEnd } from "./job.js";
import { problemBox } from "./notices.js";
import { createPicture, showBlob } from "./picture.js";

const PICTURES_MAX = 12;

export const openOther = (collection) => async (root, id, signal) => {
  const job = await getJson(`/v1/${collection}/${encodeURIComponent(id)}`, signal);
  const head = createJobHead(job);
  const body = element("div", { class: "job-body" });
  showPage(root, head.node, body);

  function finish(whole) {
    const names = (whole.files ?? []).map((file) => file.name).filter((name) => /\.(png|svg)$/i.test(name)).slice(0, PICTURES_MAX);
    const pictures = names.map((name) => {
      const { node, image } = createPicture(name);
      getBlob(`${pathOf(whole)}/files/${encodeURIComponent(name)}`, signal).then((blob) => showBlob(image, blob))
        .catch((error) => error.name === "AbortError" || node.after(problemBox(error)));
      return node;
    });
    const warnings = (whole.summary?.warnings ?? []).filter((warning) => typeof warning === "string");
    show(body, warnings.length > 0 && warningList(warnings), pictures.length > 0 && section("pictures", "Pictures", ...pictures),
      downloadList(whole), inputText(whole));
  }

  await showAtEnd(job, { head, body, announced: "Pictures and files appear here when the run is done.", finish, signal });
};
