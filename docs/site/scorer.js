// Pages that explain a word come before the start page, the README and the history, which name it; other scores are Sphinx's.
var Scorer = {
    score: ([page, , , , score]) => score - (/^(index|README|CHANGELOG|benchmarks\/|docs\/reference\/)/.test(page) ? 3 : 0),
    objNameMatch: 11, objPartialMatch: 6, objPrio: { 0: 15, 1: 5, 2: -5 }, objPrioDefault: 0,
    title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};
