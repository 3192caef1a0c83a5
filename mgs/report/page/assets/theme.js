// Light and dark colours.
"use strict";

/** Button that changes between light and dark; at first the page is as the system is. */
function themeButton() {
  const root = document.documentElement;
  const dark = () => root.dataset.theme === "dark";
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const apply = (on) => {
    root.dataset.theme = on ? "dark" : "light";
    button.textContent = on ? "Light" : "Dark";
    repaint();
  };
  const button = make("button", { class: "push", title: "Colours of the page", onclick: () => apply(!dark()) });
  apply(system.matches);
  system.addEventListener("change", (event) => apply(event.matches));
  return button;
}

/** Everything that is drawn takes the colours of the theme anew. */
function repaint() {
  for (const dot of document.querySelectorAll("[data-colour]")) {
    dot.style.background = colourOf(dot.dataset.colour);
  }
  window.dispatchEvent(new Event("repaint"));
}
