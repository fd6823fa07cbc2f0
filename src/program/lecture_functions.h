// Which functions of the common text a stage of a lecture-form file needs: a function that traces rays may stand there
// although no intersection shader could contain it.
#ifndef QUINTET_PROGRAM_LECTURE_FUNCTIONS_H
#define QUINTET_PROGRAM_LECTURE_FUNCTIONS_H

#include <string_view>
#include <utility>
#include <vector>

#include "program/lecture_split.h"

namespace quintet::program {

using TextRange = std::pair<std::size_t, std::size_t>;  // begin, end

// For each main, the definitions of common functions that neither it nor anything it uses names. One that no stage uses
// is left to the ray generation shader alone, so that the compiler has seen it.
std::vector<std::vector<TextRange>> unusedFunctions(std::string_view text, const std::vector<Token>& tokens,
                                                    const LectureSplit& split);

}  // namespace quintet::program
#endif
