#include "core/placement/layer_filter.hpp"

#include "core/base/guard.hpp"
#include "core/base/progress.hpp"
#include "core/placement/edge_probes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace thicket {

namespace {

/// Points between two checks of the cancel flag: less than a millisecond of work.
constexpr std::size_t points_per_check = 2048;

constexpr std::array<glm::dvec2, edge_probes> probe_offsets = edge_probe_offsets();

} // namespace

void LayerFilter::set(const LayerSettings &layer, std::span<const LayerFilter *const> neighbors) {
	// The rules are valid, so memory is the only possible failure.
	throw_if_out_of_memory(rules_.set(layer.rules, layer.set.seed));
	layer_ = &layer;
	neighbors_.assign(neighbors.begin(), neighbors.end());
}

Status LayerFilter::sample(
		TileSampler &sampler, const Rect &window, const std::atomic<bool> *cancel, LentThreads *threads) {
	window_ = window;
	if (rules_.closed_in(window)) {
		// If the rules let nothing pass, nothing needs to be sampled.
		points_.clear();
	} else if (const Status status =
					   sampler.sample(layer_->set, window, points_, {.cancel = cancel, .report = {}}, threads);
			!status.ok()) {
		return status;
	}
	if (const Status status = ask_position(); !status.ok()) {
		return status;
	}
	keep_points(false);
	return look_around();
}

Status LayerFilter::take(std::span<const glm::dvec2> places, const Rect &window) {
	window_ = window;
	points_.clear();
	for (const glm::dvec2 place : places) {
		points_.push_back({.position = place, .id = points_.size(), .rank = 0, .level = 0});
	}
	if (const Status status = ask_position(); !status.ok()) {
		return status;
	}
	keep_points(true);
	return look_around();
}

/// Evaluates the rules of position at all points.
Status LayerFilter::ask_position() {
	sampled_ = points_.size();
	sampled_positions_.resize(sampled_);
	sampled_densities_.resize(sampled_);
	std::transform(points_.begin(), points_.end(), sampled_positions_.begin(),
			[](const SamplePoint &point) { return point.position; });
	return rules_.place_densities(sampled_positions_, sampled_densities_, scratch_);
}

/// Splits the points, or those that pass the rules of position, into separate arrays.
void LayerFilter::keep_points(bool all) {
	const auto resize = [this](std::size_t count) {
		positions_.resize(count);
		ids_.resize(count);
		ranks_.resize(count);
		densities_.resize(count);
	};
	resize(sampled_);
	// Has no branch, because densities would often mispredict it: the next point overwrites a removed one.
	std::size_t kept = 0;
	for (std::size_t i = 0; i < sampled_; ++i) {
		positions_[kept] = points_[i].position;
		ids_[kept] = points_[i].id;
		ranks_[kept] = points_[i].rank;
		densities_[kept] = sampled_densities_[i];
		kept += all || stands(points_[i].rank, sampled_densities_[i]) ? 1 : 0;
	}
	resize(kept);
}

Status LayerFilter::look_around() {
	near_shapes_.clear();
	if (const ShapeSet *shapes = rules_.rules().shapes.get()) {
		// Probes may lie outside the window.
		const double around = rules_.rules().edge_feather;
		throw_if_out_of_memory(shapes->near({window_.min - around, window_.max + around}, near_shapes_));
	}
	return open_probes();
}

Status LayerFilter::open_probes() {
	probes_.clear();
	probe_open_.clear();
	const double feather = rules_.rules().edge_feather;
	if (feather <= 0.0) {
		return {};
	}
	for (const glm::dvec2 position : positions_) {
		for (const glm::dvec2 offset : probe_offsets) {
			probes_.push_back(position + feather * offset);
		}
	}
	sampled_densities_.resize(probes_.size());
	const Status status = rules_.place_densities(probes_, sampled_densities_, scratch_);
	probe_open_.resize(probes_.size());
	std::transform(sampled_densities_.begin(), sampled_densities_.end(), probe_open_.begin(),
			[](double density) { return density > 0.0; });
	return status;
}

void LayerFilter::add_queries(
		bool normals, std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const {
	const std::vector<std::int32_t> &textures = layer_->rules.ground_textures;
	const bool slope = rules_.look_at_slope();
	if (slope || !normals || probes_.empty()) {
		r_queries.push_back({r_positions.size(), position_count(), {textures, slope || normals}});
	} else {
		// The normals of the probes are not needed.
		r_queries.push_back({r_positions.size(), positions_.size(), {textures, true}});
		r_queries.push_back({r_positions.size() + positions_.size(), probes_.size(), {textures, false}});
	}
	r_positions.insert(r_positions.end(), positions_.begin(), positions_.end());
	r_positions.insert(r_positions.end(), probes_.begin(), probes_.end());
}

bool LayerFilter::probe_allows(std::size_t probe, const Ground &ground) const {
	return probe_open_[probe] != 0 && rules_.allow(ground, probes_[probe]) &&
			rules_.shape_density(near_shapes_, probes_[probe], ground) > 0.0;
}

template <class Record>
double LayerFilter::edge_density_at(
		std::size_t point, std::span<const Ground> probe_ground, const Record &record) const {
	std::size_t allowed = 0;
	for (std::size_t i = 0; i < edge_probes; ++i) {
		const std::size_t probe = point * edge_probes + i;
		allowed += probe_allows(probe, probe_ground[probe]) ? 1 : 0;
	}
	const double share = static_cast<double>(allowed) / static_cast<double>(edge_probes);
	return record(RuleKind::edge_feather, share, edge_density(allowed));
}

template <class Record>
double LayerFilter::neighbor_density(std::size_t neighbor, glm::dvec2 position, const Record &record) const {
	const Neighbor &rule = layer_->neighbors[neighbor];
	const double squared = neighbors_[neighbor]->nearest_squared(position, rule.distance);
	const double distance = Record::complete || rule.curve != nullptr ? std::sqrt(squared) : 0.0;
	const double density = rule.curve != nullptr      ? rule.curve->at(distance)
			: squared < rule.distance * rule.distance ? 0.0
													  : 1.0;
	return record(RuleKind::neighbor, distance, density, static_cast<std::uint32_t>(neighbor));
}

/// The density of the rules that depend only on a point's position and the ground there.
template <class Record>
double LayerFilter::density_alone(std::size_t point, std::span<const Ground> ground, const Record &record) const {
	return densities_[point] * rules_.ground_density(ground[point], positions_[point], record);
}

/// Evaluates the rules in the order of their cost, and stops once a point's density has fallen below its rank.
template <class Record>
double LayerFilter::product(std::size_t point, std::span<const Ground> ground, const Record &record) const {
	const Ground &here = ground[point];
	double density = density_alone(point, ground, record);
	if (Record::complete && !std::isfinite(here.height)) {
		return density; // The density is 0, and the other rules cannot be evaluated without ground.
	}
	const auto goes_on = [&] {
		return Record::complete || stands(ranks_[point], density);
	};
	if (goes_on()) {
		density *= rules_.shape_density(near_shapes_, positions_[point], here, record);
	}
	for (std::size_t i = 0; i < neighbors_.size() && goes_on(); ++i) {
		density *= neighbor_density(i, positions_[point], record);
	}
	if (!probe_open_.empty() && goes_on()) {
		density *= edge_density_at(point, ground.subspan(positions_.size()), record);
	}
	return density;
}

double LayerFilter::density_at(std::size_t point, std::span<const Ground> ground) const {
	return product(point, ground, NoRecord());
}

Status LayerFilter::factors_at(
		std::size_t point, std::span<const Ground> ground, std::vector<RuleFactor> &r_factors) const {
	const RuleRecord record(r_factors);
	const Status status = rules_.place_factors(positions_[point], record);
	if (status.ok()) {
		product(point, ground, record);
	}
	return status;
}

Status LayerFilter::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	const bool looks_further = rules_.rules().shapes != nullptr || !neighbors_.empty() || !probe_open_.empty();
	standing_.resize(positions_.size());
	thinning_ranks_.resize(positions_.size());
	std::size_t standing = 0; // As in keep_points.
	for (std::size_t first = 0; first < positions_.size(); first += points_per_check) {
		if (is_cancelled(cancel)) {
			standing_.clear();
			thinning_ranks_.clear();
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::size_t end = std::min(first + points_per_check, positions_.size());
		for (std::size_t point = first; point < end; ++point) {
			const double density = looks_further ? density_at(point, ground) : density_alone(point, ground, NoRecord());
			standing_[standing] = static_cast<std::uint32_t>(point);
			thinning_ranks_[standing] = thinning_rank(ranks_[point], density);
			standing += stands(ranks_[point], density) ? 1 : 0;
		}
	}
	standing_.resize(standing);
	thinning_ranks_.resize(standing);
	return {};
}

void LayerFilter::index_standing(double distance) {
	standing_positions_.clear();
	for (const std::uint32_t point : standing_) {
		standing_positions_.push_back(positions_[point]);
	}
	grid_.set(standing_positions_, window_, std::max(distance, layer_->set.radius));
}

} // namespace thicket
