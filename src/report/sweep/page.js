"use strict";
const find = (id) => document.getElementById(id);
const show = (side) => {
  const name = find(side).value;
  const source = find("picture-" + name);
  const target = find("slider-" + side);
  if (source) {
    target.src = source.src;
    target.alt = source.alt;
  }
};
for (const side of ["left", "right"]) {
  find(side).addEventListener("change", () => show(side));
}
// The first configuration against the reference.
find("left").selectedIndex = Math.min(1, find("left").options.length - 1);
show("left");
show("right");
find("split").addEventListener("input", (event) => {
  find("slider").style.setProperty("--split", event.target.value + "%");
});
