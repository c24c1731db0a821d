// The page of terms, and those that explain a word, come before those that name it; other scores are Sphinx's.
var Scorer = {
    score: ([page, , , , score]) => score + 3 * (page === "docs/terms")
        - 3 * /^(index|README|CHANGELOG|SECURITY|benchmarks\/|docs\/reference\/)/.test(page),
    objNameMatch: 11, objPartialMatch: 6, objPrio: { 0: 15, 1: 5, 2: -5 }, objPrioDefault: 0,
    title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};
