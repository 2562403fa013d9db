// The page: the theme, and the recording that is open; of several, the one that was chosen in the index.

function dataOf(number) {
  return JSON.parse(document.getElementById(`data-${number}`).textContent);
}

function open(number) {
  const article = document.createElement("article");
  article.className = "run";
  article.append(document.querySelector(`template[data-run="${number}"]`).content.cloneNode(true));
  const back = document.createElement("button");
  back.className = "back";
  back.textContent = "All recordings";
  back.addEventListener("click", () => { location.hash = ""; });
  article.prepend(back);
  document.getElementById("main").append(article);
  new Run(article, dataOf(number));
  back.focus();
  scrollTo(0, 0);
}

// The address says which recording is open, so that it can be passed on and the browser's way back works.
function follow() {
  const index = document.querySelector(".index");
  document.querySelectorAll("article.run").forEach((article) => article.remove());
  const number = /^#recording-(\d+)$/.exec(location.hash)?.[1];
  const isThere = number !== undefined && document.querySelector(`template[data-run="${number}"]`);
  index.hidden = !!isThere;
  repaint.clear();
  if (isThere) open(Number(number));
}

function startIndex(index) {
  index.addEventListener("click", (event) => {
    const button = event.target.closest(".open-run");
    if (button) location.hash = `recording-${button.dataset.run}`;
  });
  index.querySelector(".filter input").addEventListener("change", (event) => {
    for (const row of index.querySelectorAll("tbody tr")) row.hidden = event.target.checked && row.dataset.standing === "good";
  });
  addEventListener("hashchange", follow);
  follow();
}

startTheme(document.querySelector(".theme"));
const index = document.querySelector(".index");
if (index) startIndex(index); else new Run(document.querySelector("article.run"), dataOf(0));
