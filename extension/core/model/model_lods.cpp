#include "core/model/model_lods.hpp"

#include "core/model/letters.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace thicket {

namespace {

constexpr std::string_view mark = "lod";
constexpr std::size_t max_digits = 2;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_separator(char c) { return c == '_' || c == '-' || c == '.' || c == ' '; }

bool has_mark_at(std::string_view name, std::size_t at) {
	return at + mark.size() <= name.size() &&
			std::equal(mark.begin(), mark.end(), name.begin() + static_cast<std::ptrdiff_t>(at),
					[](char a, char b) { return a == lower(b); });
}

/// Returns the name without the characters in [from, to) and the separators before them. If the
/// name starts with these characters, the separators after them are removed instead.
std::string without(std::string_view name, std::size_t from, std::size_t to) {
	while (from > 0 && is_separator(name[from - 1])) {
		--from;
	}
	if (from == 0) {
		while (to < name.size() && is_separator(name[to])) {
			++to;
		}
	}
	return std::string(name.substr(0, from)) + std::string(name.substr(to));
}

/// Returns the LOD number of each part. Parts that are drawn in all LODs have none.
std::vector<std::optional<int>> numbers_of(std::span<const PartRange> parts) {
	std::set<std::string_view> numbered_stems;
	for (const PartRange &part : parts) {
		if (part.lod) {
			numbered_stems.insert(part.stem);
		}
	}
	std::vector<std::optional<int>> numbers;
	for (const PartRange &part : parts) {
		const bool finest = !part.lod && numbered_stems.contains(part.stem);
		numbers.push_back(finest ? 0 : part.lod);
	}
	return numbers;
}

std::vector<ModelLod> lods_by_number(std::span<const PartRange> parts) {
	const std::vector<std::optional<int>> numbers = numbers_of(parts);
	std::map<int, ModelLod> lods;
	for (std::size_t index = 0; index < parts.size(); ++index) {
		if (numbers[index]) {
			ModelLod &lod = lods[*numbers[index]];
			if (parts[index].begin > 0.0) {
				lod.distance = std::max(lod.distance.value_or(0.0), parts[index].begin);
			}
		}
	}
	for (std::size_t index = 0; index < parts.size(); ++index) {
		for (auto &[number, lod] : lods) {
			if (numbers[index].value_or(number) == number) {
				lod.parts.push_back(index);
			}
		}
	}
	std::vector<ModelLod> result;
	for (auto &[number, lod] : lods) {
		result.push_back(std::move(lod));
	}
	result.front().distance = 0.0;
	return result;
}

std::vector<ModelLod> lods_by_range(std::span<const PartRange> parts) {
	std::set<double> distances{0.0};
	for (const PartRange &part : parts) {
		distances.insert(std::max(part.begin, 0.0));
		distances.insert(std::max(part.end, 0.0));
	}
	std::vector<ModelLod> result;
	for (const double distance : distances) {
		ModelLod lod{distance, {}};
		for (std::size_t index = 0; index < parts.size(); ++index) {
			if (parts[index].begin <= distance && (parts[index].end <= 0.0 || distance < parts[index].end)) {
				lod.parts.push_back(index);
			}
		}
		if (!lod.parts.empty() && (result.empty() || result.back().parts != lod.parts)) {
			result.push_back(std::move(lod));
		}
	}
	if (!result.empty()) {
		result.front().distance = 0.0;
	}
	return result;
}

} // namespace

LodName read_lod_name(std::string_view name) {
	LodName result{std::string(name), std::nullopt};
	for (std::size_t at = 0; at + mark.size() < name.size(); ++at) {
		if (!has_mark_at(name, at) || !begins_word(name, at)) {
			continue;
		}
		std::size_t digits = at + mark.size();
		digits += is_separator(name[digits]) ? 1 : 0;
		std::size_t end = digits;
		int number = 0;
		for (; end < name.size() && is_digit(name[end]); ++end) {
			number = std::min(10 * number + (name[end] - '0'), 1000);
		}
		const bool whole_word = end == name.size() || !(is_upper(name[end]) || is_lower(name[end]));
		if (end > digits && end - digits <= max_digits && whole_word) {
			result = {without(name, at, end), number};
		}
	}
	return result;
}

std::vector<ModelLod> model_lods(std::span<const PartRange> parts) {
	const bool numbered = std::ranges::any_of(parts, [](const PartRange &part) { return part.lod.has_value(); });
	return numbered ? lods_by_number(parts) : lods_by_range(parts);
}

double usual_lod_distance(double size, std::size_t lod) {
	// Distance of the first coarser LOD, as a multiple of the model's size. At this distance, a
	// model is about half as high as the screen with Godot's default field of view.
	constexpr double first = 2.5;
	constexpr double step = 2.0;
	double distance = first * size;
	for (std::size_t at = 1; at < lod; ++at) {
		distance *= step;
	}
	return lod == 0 ? 0.0 : distance;
}

} // namespace thicket
