#include "core/model/model_fit.hpp"

#include "core/model/letters.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace thicket {

namespace {

constexpr double tan_25_degrees = 0.46630765815499858;

/// English words in the singular. Names are checked before sizes, because low-poly bushes and trees
/// are often so small and solid that their size suggests a rock.
constexpr std::array<std::pair<std::string_view, ModelKind>, 66> words{{
		{"acacia", ModelKind::tree},
		{"alder", ModelKind::tree},
		{"aspen", ModelKind::tree},
		{"baobab", ModelKind::tree},
		{"beech", ModelKind::tree},
		{"birch", ModelKind::tree},
		{"cedar", ModelKind::tree},
		{"conifer", ModelKind::tree},
		{"cypress", ModelKind::tree},
		{"elm", ModelKind::tree},
		{"eucalyptus", ModelKind::tree},
		{"fir", ModelKind::tree},
		{"larch", ModelKind::tree},
		{"linden", ModelKind::tree},
		{"maple", ModelKind::tree},
		{"oak", ModelKind::tree},
		{"palm", ModelKind::tree},
		{"pine", ModelKind::tree},
		{"poplar", ModelKind::tree},
		{"redwood", ModelKind::tree},
		{"sequoia", ModelKind::tree},
		{"spruce", ModelKind::tree},
		{"tree", ModelKind::tree},
		{"willow", ModelKind::tree},
		{"agave", ModelKind::shrub},
		{"bramble", ModelKind::shrub},
		{"bush", ModelKind::shrub},
		{"cactus", ModelKind::shrub},
		{"gorse", ModelKind::shrub},
		{"hazel", ModelKind::shrub},
		{"heather", ModelKind::shrub},
		{"hedge", ModelKind::shrub},
		{"juniper", ModelKind::shrub},
		{"sagebrush", ModelKind::shrub},
		{"shrub", ModelKind::shrub},
		{"thicket", ModelKind::shrub},
		{"bluebell", ModelKind::grass},
		{"clover", ModelKind::grass},
		{"crop", ModelKind::grass},
		{"daisy", ModelKind::grass},
		{"fern", ModelKind::grass},
		{"flower", ModelKind::grass},
		{"grass", ModelKind::grass},
		{"herb", ModelKind::grass},
		{"lavender", ModelKind::grass},
		{"moss", ModelKind::grass},
		{"mushroom", ModelKind::grass},
		{"nettle", ModelKind::grass},
		{"poppy", ModelKind::grass},
		{"reed", ModelKind::grass},
		{"sedge", ModelKind::grass},
		{"toadstool", ModelKind::grass},
		{"tulip", ModelKind::grass},
		{"weed", ModelKind::grass},
		{"wheat", ModelKind::grass},
		{"boulder", ModelKind::rock},
		{"cliff", ModelKind::rock},
		{"gravel", ModelKind::rock},
		{"log", ModelKind::rock},
		{"pebble", ModelKind::rock},
		{"rock", ModelKind::rock},
		{"rubble", ModelKind::rock},
		{"scree", ModelKind::rock},
		{"slab", ModelKind::rock},
		{"stone", ModelKind::rock},
		{"stump", ModelKind::rock},
}};

/// Returns the kind that a lowercase word denotes.
std::optional<ModelKind> kind_of_word(std::string_view word) {
	// The loop removes the plural ending of "trees" and "bushes", but keeps the "s" of "moss",
	// "cactus" and "grass".
	for (const std::string_view plural : {"", "s", "es"}) {
		if (word.ends_with(plural)) {
			const std::string_view singular = word.substr(0, word.size() - plural.size());
			for (const auto &[known, kind] : words) {
				if (known == singular) {
					return kind;
				}
			}
		}
	}
	return std::nullopt;
}

} // namespace

std::optional<ModelKind> kind_named(std::string_view name) {
	std::optional<ModelKind> kind;
	std::string word;
	for (std::size_t at = 0; at <= name.size(); ++at) {
		const bool in_word = at < name.size() && is_letter(name[at]);
		if (!in_word || begins_word(name, at)) {
			if (const std::optional<ModelKind> named = kind_of_word(word)) {
				kind = named;
			}
			word.clear();
		}
		if (in_word) {
			word += lower(name[at]);
		}
	}
	return kind;
}

ModelKind kind_of(const ModelSize &size) {
	const double tall = size.height + size.depth;
	if (tall >= 2.5 && tall >= 1.2 * size.width) {
		return ModelKind::tree;
	}
	if (size.fill >= 0.25) {
		return ModelKind::rock;
	}
	return tall < 0.7 ? ModelKind::grass : ModelKind::shrub;
}

ModelFit fit_of(ModelKind kind, const ModelSize &size) {
	ModelFit fit;
	// The height of the lower edge of an upright base above a slope of 25 degrees.
	const double below_slope = 0.5 * size.base * tan_25_degrees;
	double sink = 0.0;
	switch (kind) {
		case ModelKind::tree:
			fit = {.radius = 0.9 * size.footprint,
					.density = 0.85,
					.min_scale = 0.75,
					.max_scale = 1.25,
					.max_tilt_degrees = 4.0};
			sink = below_slope;
			break;
		case ModelKind::shrub:
			fit = {.radius = size.footprint,
					.density = 0.8,
					.min_scale = 0.65,
					.max_scale = 1.3,
					.max_tilt_degrees = 8.0,
					.align_to_normal = 0.3};
			fit.clump_size = 10.0 * fit.radius;
			sink = std::min(below_slope, 0.15 * size.height) * (1.0 - fit.align_to_normal);
			break;
		case ModelKind::grass:
			fit = {.radius = 0.7 * size.footprint,
					.min_scale = 0.7,
					.max_scale = 1.3,
					.max_tilt_degrees = 10.0,
					.align_to_normal = 0.7};
			sink = std::min(below_slope, 0.2 * size.height) * (1.0 - fit.align_to_normal);
			break;
		case ModelKind::rock:
			fit = {.radius = 1.6 * size.footprint,
					.density = 0.7,
					.min_scale = 0.4,
					.max_scale = 1.4,
					.max_tilt_degrees = 12.0,
					.align_to_normal = 0.6};
			fit.clump_size = 12.0 * fit.radius;
			fit.clump_coverage = 0.3;
			sink = 0.2 * size.height;
			break;
	}
	fit.height_offset = std::min(size.depth - sink, 0.0);
	return fit;
}

} // namespace thicket
