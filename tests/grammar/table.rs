//! The LALR(1) table of a grammar, as far as it takes to see conflicts: LR(0) states, each with the lookaheads of all
//! the ways that lead to it (Aho, Sethi and Ullman, "Compilers", 1986, section 4.7).

use std::collections::{BTreeMap, BTreeSet};

use super::Grammar;

/// A rule and how much of its right side has been read.
type Item = (usize, usize);
type Words = BTreeSet<String>;
type State = BTreeMap<Item, Words>;

/// What follows a scene.
const END: &str = "END";

struct Table<'a> {
    grammar: &'a Grammar,
    empty: BTreeSet<&'a str>,
    first: BTreeMap<&'a str, Words>,
}

impl<'a> Table<'a> {
    fn new(grammar: &'a Grammar) -> Self {
        let mut table = Self { grammar, empty: BTreeSet::new(), first: BTreeMap::new() };
        loop {
            let before = table.size();
            for (left, right) in &grammar.rules {
                let (words, empty) = table.first_of(right);
                table.first.entry(left).or_default().extend(words);
                if empty {
                    table.empty.insert(left);
                }
            }
            if table.size() == before {
                return table;
            }
        }
    }

    fn size(&self) -> usize {
        self.empty.len() + self.first.values().map(BTreeSet::len).sum::<usize>()
    }

    /// The words that `symbols` may begin with, and whether they may be nothing.
    fn first_of(&self, symbols: &[String]) -> (Words, bool) {
        let mut words = Words::new();
        for symbol in symbols {
            if !self.grammar.is_rule(symbol) {
                words.insert(symbol.clone());
                return (words, false);
            }
            words.extend(self.first.get(symbol.as_str()).into_iter().flatten().cloned());
            if !self.empty.contains(symbol.as_str()) {
                return (words, false);
            }
        }
        (words, true)
    }

    fn next(&self, (rule, read): Item) -> Option<&'a str> {
        self.grammar.rules[rule].1.get(read).map(String::as_str)
    }

    fn closure(&self, kernel: &State) -> State {
        let mut state = kernel.clone();
        let mut waiting: Vec<Item> = state.keys().copied().collect();
        while let Some(item) = waiting.pop() {
            let Some(symbol) = self.next(item) else { continue };
            let (mut words, empty) = self.first_of(&self.grammar.rules[item.0].1[item.1 + 1..]);
            if empty {
                words.extend(state[&item].iter().cloned());
            }
            let rules = self.grammar.rules.iter().enumerate();
            for (rule, _) in rules.filter(|(_, (left, _))| left == symbol) {
                let known = state.entry((rule, 0)).or_default();
                let before = known.len();
                known.extend(words.iter().cloned());
                if known.len() > before {
                    waiting.push((rule, 0));
                }
            }
        }
        state
    }

    /// Every state, closed.
    fn states(&self) -> Vec<State> {
        let start = State::from([((0, 0), Words::from([END.to_owned()]))]);
        let (mut kernels, mut places) = (vec![start.clone()], BTreeMap::new());
        places.insert(start.into_keys().collect::<Vec<_>>(), 0);
        let mut waiting = BTreeSet::from([0]);
        while let Some(at) = waiting.pop_first() {
            let mut steps: BTreeMap<&str, State> = BTreeMap::new();
            for (item, words) in self.closure(&kernels[at]) {
                if let Some(symbol) = self.next(item) {
                    steps.entry(symbol).or_default().insert((item.0, item.1 + 1), words);
                }
            }
            for step in steps.into_values() {
                let items: Vec<Item> = step.keys().copied().collect();
                let place = *places.entry(items).or_insert_with(|| {
                    waiting.insert(kernels.len());
                    kernels.push(step.clone());
                    kernels.len() - 1
                });
                for (item, words) in step {
                    let known = kernels[place].get_mut(&item).unwrap();
                    if !known.is_superset(&words) {
                        known.extend(words);
                        waiting.insert(place);
                    }
                }
            }
        }
        kernels.iter().map(|kernel| self.closure(kernel)).collect()
    }
}

/// Where one word ahead does not tell what to do.
fn conflicts(grammar: &Grammar) -> Vec<String> {
    let table = Table::new(grammar);
    let mut found = BTreeSet::new();
    for state in table.states() {
        let shifts: BTreeSet<&str> = state.keys().filter_map(|&item| table.next(item)).collect();
        let mut reduced: BTreeMap<&str, usize> = BTreeMap::new();
        for (&item, words) in state.iter().filter(|(item, _)| table.next(**item).is_none()) {
            for word in words {
                let rule = &grammar.rules[item.0];
                if shifts.contains(word.as_str()) {
                    found.insert(format!("{word} goes on, or ends {rule:?}"));
                }
                if let Some(other) = reduced.insert(word, item.0) {
                    found.insert(format!("{word} ends {:?}, or {rule:?}", grammar.rules[other]));
                }
            }
        }
    }
    found.into_iter().collect()
}

#[test]
fn one_word_ahead_is_enough() {
    let found = conflicts(&Grammar::read());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Grammars of which it is known (Aho, Sethi and Ullman, examples 4.33, 4.39 and 4.44).
#[test]
fn conflicts_are_seen() {
    let assignment = "s : l \"=\" r | r\nl : \"*\" r | ID\nr : l\n";
    let merged =
        "s : \"a\" x \"d\" | \"b\" y \"d\" | \"a\" y \"e\" | \"b\" x \"e\"\nx : \"c\"\ny : \"c\"\n";
    let dangling = "s : \"if\" s | \"if\" s \"else\" s | ID\n";
    let sums = "e : e \"+\" t | t\nt : t \"*\" f | f\nf : \"(\" e \")\" | ID\n";
    for (rules, wrong) in [
        (assignment, 0),
        // LR(1), but not LALR(1): two states become one.
        (merged, 2),
        (dangling, 1),
        (sums, 0),
        ("s : s s | ID\n", 1),
    ] {
        let start = &rules[..1];
        let grammar = Grammar::parse(&format!("scene : {start}\n{rules}"), "ID x\n");
        let found = conflicts(&grammar);
        assert_eq!(found.len(), wrong, "{rules}: {found:?}");
    }
}
