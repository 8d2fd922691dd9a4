#include "engine/simulation/tool_kernel.h"

#include <array>
#include <utility>

namespace spoonbill {
namespace {

using Maker = ToolKernel (*)();

template <std::size_t... places>
constexpr std::array<Maker, sizeof...(places)> make_makers(std::index_sequence<places...>) {
  return {[]() -> ToolKernel { return tool_kernel(KernelOf<tool_actions[places].action>{}); }...};
}

constexpr auto makers = make_makers(std::make_index_sequence<tool_actions.size()>());

}  // namespace

ToolKernel kernel_of(ToolAction action) {
  return makers[static_cast<std::size_t>(action)]();
}

}  // namespace spoonbill
