// Adds a list of all versions of the site. versions-list.js, in the folder above this version, sets window.siteVersions.
document.addEventListener("DOMContentLoaded", () => {
  const root = document.documentElement.dataset.content_root || "./";
  const list = document.createElement("script");
  list.src = root + "../versions-list.js";
  list.onload = () => {
    const brand = document.querySelector(".sidebar-brand");
    const here = new URL(root, location.href);
    const current = decodeURIComponent(here.pathname.replace(/\/$/, "").split("/").pop());
    const select = document.createElement("select");
    select.setAttribute("aria-label", "Version");
    for (const version of window.siteVersions) select.add(new Option(version, version, false, version === current));
    select.onchange = () => { location.href = new URL("../" + select.value + "/index.html", here); };
    const box = document.createElement("div");
    box.className = "versions";
    box.append(select);
    brand.after(box);
  };
  document.head.append(list);
});
