// A button that copies each block of code; words that break in no place, and what fits the width of the page.
addEventListener("DOMContentLoaded", () => {
    for (const code of document.querySelectorAll("article div.highlight pre, article .output pre")) {
        if (code.closest(".highlight-text, .output")) {
            const lengths = code.textContent.split("\n").map((line) => line.length);
            code.style.setProperty("--columns", Math.min(80, Math.max(40, ...lengths)));
            continue;
        }
        const button = Object.assign(document.createElement("button"), {
            className: "copy", type: "button", textContent: "Copy", ariaLabel: "Copy this block",
        });
        const typed = code.textContent.trimEnd().split("\n");
        const prompts = typed.filter((line) => /^(>>>|\.\.\.)/.test(line));  // of an example: not what it prints
        const copied = (prompts.length ? prompts.map((line) => line.slice(4)) : typed).join("\n") + "\n";
        button.onclick = async () => {
            await navigator.clipboard.writeText(copied);
            button.textContent = "Copied";
            setTimeout(() => { button.textContent = "Copy"; }, 1500);
        };
        code.closest("div[class*='highlight-']").append(button);
    }
    for (const code of document.querySelectorAll("article pre, article code")) {
        const texts = document.createTreeWalker(code, NodeFilter.SHOW_TEXT), found = [];
        while (texts.nextNode()) if (texts.currentNode.data.includes("-")) found.push(texts.currentNode);
        for (const text of found) {
            const parts = text.data.split(/((?<!\S)\S{0,30}-\S{0,30}(?!\S))/);
            text.replaceWith(...parts.map((part, i) => i % 2
                ? Object.assign(document.createElement("span"), {className: "whole", textContent: part}) : part));
        }
    }
    for (const picture of document.querySelectorAll("article img"))  // at its full size
        if (!picture.closest("a")) {
            const link = Object.assign(document.createElement("a"), {href: picture.src});
            picture.replaceWith(link);
            link.append(picture);
        }
    const tables = [...document.querySelectorAll("article .table-wrapper > table")];
    for (const table of tables) {
        const names = [...table.querySelectorAll("thead th")].map((head) => head.innerText.trim());
        for (const row of table.querySelectorAll("tbody tr"))
            [...row.cells].forEach((cell, column) => {
                cell.dataset.column = names[column] ?? "";
                cell.classList.toggle("empty", ["", "-"].includes(cell.innerText.trim()));
                cell.classList.toggle("whole", cell.innerText.length <= 10);
            });
    }
    const tooWide = (box) => box.scrollWidth > box.clientWidth;
    const tall = (cell) => cell.clientHeight > 5.5 * parseFloat(getComputedStyle(cell).lineHeight);
    const fit = () => {
        for (const table of tables) {
            table.classList.remove("small", "stacked");
            if (tooWide(table.parentElement)) table.classList.add("small");
            if (tooWide(table.parentElement) || (table.matches(".small") && [...table.querySelectorAll("td")].some(tall)))
                table.classList.add("stacked");
        }
        for (const formula of document.querySelectorAll("article .formula")) {
            formula.style.fontSize = "";
            if (tooWide(formula)) formula.style.fontSize = `${0.97 * formula.clientWidth / formula.scrollWidth}em`;
        }
    };
    addEventListener("resize", fit);
    fit();
});
