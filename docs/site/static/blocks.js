// A button that copies each block of code; what a program has printed, and tables, fit the width of the page.
addEventListener("DOMContentLoaded", () => {
    for (const code of document.querySelectorAll("article div.highlight pre, article .output pre")) {
        if (code.closest(".highlight-text, .output")) {
            const longest = Math.max(40, ...code.textContent.split("\n").map((line) => line.length));
            code.style.setProperty("--columns", longest);
            continue;
        }
        const button = Object.assign(document.createElement("button"), {
            className: "copy", type: "button", textContent: "Copy", ariaLabel: "Copy this block",
        });
        button.onclick = async () => {
            await navigator.clipboard.writeText(code.textContent.trimEnd() + "\n");
            button.textContent = "Copied";
            setTimeout(() => { button.textContent = "Copy"; }, 1500);
        };
        code.closest("div[class*='highlight-']").append(button);
    }
    const tables = [...document.querySelectorAll("article .table-wrapper > table")];
    for (const table of tables) {
        const names = [...table.querySelectorAll("thead th")].map((head) => head.innerText.trim());
        for (const row of table.querySelectorAll("tbody tr"))
            [...row.cells].forEach((cell, column) => { cell.dataset.column = names[column] ?? ""; });
    }
    const fit = () => {
        for (const table of tables) {
            table.classList.remove("small", "stacked");
            for (const way of ["small", "stacked"])
                if (table.parentElement.scrollWidth > table.parentElement.clientWidth) table.classList.add(way);
        }
    };
    addEventListener("resize", fit);
    fit();
});
