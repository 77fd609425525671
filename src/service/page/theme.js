// A classic script in the head, not a module: it must set the colours before the first paint.
// "auto" follows the system, and keeps following it while the page is open.
(() => {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const read = () => {
    try {
      return localStorage.getItem("perilife.theme") ?? "auto";
    } catch {
      return "auto"; // storage switched off: the choice then lasts as long as the page
    }
  };
  let choice = read();
  const apply = () => {
    const dark = choice === "dark" || (choice === "auto" && system.matches);
    document.documentElement.dataset.theme = dark ? "dark" : "light";
  };
  system.addEventListener("change", apply);
  // Paper is white.
  addEventListener("beforeprint", () => {
    document.documentElement.dataset.theme = "light";
  });
  addEventListener("afterprint", apply);
  apply();
  document.addEventListener("DOMContentLoaded", () => {
    document.getElementById("theme").addEventListener("click", () => {
      const other = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
      // Back at what the system has, the page follows it again.
      choice = (other === "dark") === system.matches ? "auto" : other;
      try {
        localStorage.setItem("perilife.theme", choice);
      } catch {
        // see above
      }
      apply();
    });
  });
})();
