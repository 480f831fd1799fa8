// Which results of the search come first: tutorials before descriptions, and last what was tried, measured or changed once.
// The numbers below `score` are Sphinx's own.
var Scorer = {
  score: ([page, , , , score]) => {
    if (page.startsWith('scenes/examples/tutorials/') || page.endsWith('/FORCES')) return score + 4;
    if (/(^|\/)(HISTORY|CHANGELOG)$|^benchmarks\/results\/|^tests\//.test(page)) return score - 4;
    return score;
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: {0: 15, 1: 5, 2: -5},
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
