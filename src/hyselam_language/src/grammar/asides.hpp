// Asides: parts between commas that say nothing of the building ("which by the way is far too
// small", "silly").
#pragma once

#include <string>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// Tokens [begin, end) between commas or the borders of the sentence, without the commas.
struct Aside {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// The parts that may be left out: they hold no word that tells of places, sides, numbers, denial
/// or doubt, and no name. None if nothing else would be left.
/// `all`: even if nothing would be left.
std::vector<Aside> asidesOf(const std::vector<Token>& tokens, const CompiledGrammar& grammar,
                            bool all = false);

/// Whether tokens [begin, end) are of another time, or deny nothing that is told beside them
/// ("which used to be a bedroom", "nobody goes in there"), without doubt; `with_nouns`: even if
/// they name something.
bool saysNothingOfNow(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
                      const CompiledGrammar& grammar, bool with_nouns);

/// Whether a word of tokens [begin, end) denies: "not", "nobody".
bool denies(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
            const CompiledGrammar& grammar);

/// "I am not sure", "não dá para ter a certeza": doubts what is told beside it.
bool doubts(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
            const CompiledGrammar& grammar);

/// Where the longest phrase ends that begins at a token, has two words or more, and that the
/// grammar leaves out beside a statement, as "if you do not mind"; `at` without one.
std::size_t fillerEnd(const std::vector<Token>& tokens, std::size_t at,
                      const CompiledGrammar& grammar);

/// "Onde se guarda a roupa": a word that refuses elsewhere, and here is a pronoun of the verb
/// behind it. Never before the verb of a condition ("que, se for à esquerda").
bool isReflexive(const std::vector<Token>& tokens, std::size_t at, const CompiledGrammar& grammar);

/// What may be left out of a correction, each time less likely: "No, I measured it again, four by
/// seven", "six, no, hang on, I counted them, seven". Never what has a name, a kind of place, a
/// number or doubt.
std::vector<std::vector<Aside>> asidesOfCorrections(const std::vector<Token>& tokens,
                                                    const CompiledGrammar& grammar);

/// The tokens without an aside: a comma stands for it.
std::vector<Token> without(const std::vector<Token>& tokens, const std::vector<Aside>& asides);

}  // namespace language
}  // namespace hyselam_topo
