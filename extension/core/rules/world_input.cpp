#include "core/rules/world_input.hpp"

namespace thicket {

std::string text_of(const WorldInput &input) {
	const std::string name = '"' + input.name + '"';
	const std::string number = std::to_string(input.number);
	switch (input.kind) {
		case WorldInputKind::biome: return "biome(" + (input.name.empty() ? number : name) + ")";
		case WorldInputKind::texture: return "texture(" + number + ")";
		case WorldInputKind::distance: return "distance(" + name + ")";
		case WorldInputKind::mask: return std::string(mask_channel_inputs[static_cast<std::size_t>(input.number)]);
	}
	return {};
}

std::string with_renamed_layer(std::string_view text, std::string_view from, std::string_view to) {
	constexpr std::string_view function = "distance";
	constexpr std::string_view spaces = " \t\n";
	const std::string quote = to.find('"') == std::string_view::npos ? "\"" : "'";
	std::string result;
	std::size_t copied = 0;
	for (std::size_t at = text.find(function); at != std::string_view::npos; at = text.find(function, at + 1)) {
		const std::size_t parenthesis = text.find_first_not_of(spaces, at + function.size());
		if (parenthesis == std::string_view::npos || text[parenthesis] != '(') {
			continue;
		}
		const std::size_t first = text.find_first_not_of(spaces, parenthesis + 1);
		if (first == std::string_view::npos || (text[first] != '"' && text[first] != '\'')) {
			continue;
		}
		const std::size_t last = text.find(text[first], first + 1);
		if (last == std::string_view::npos || text.substr(first + 1, last - first - 1) != from) {
			continue;
		}
		result.append(text.substr(copied, first - copied)).append(quote).append(to).append(quote);
		copied = last + 1;
	}
	return result.append(text.substr(copied));
}

} // namespace thicket
