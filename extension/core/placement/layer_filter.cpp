#include "core/placement/layer_filter.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/base/progress.hpp"
#include "core/placement/edge_probes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace thicket {

namespace {

/// Number of points between two checks of the cancel flag. Processing them takes less than a
/// millisecond.
constexpr std::size_t points_per_check = 2048;

/// The same number for points on surfaces with an edge feather, whose probes are searched one by
/// one.
constexpr std::size_t surface_points_per_check = 16;

constexpr std::array<glm::dvec2, edge_probes> probe_offsets = edge_probe_offsets();

} // namespace

void LayerFilter::set(const LayerSettings &layer, std::span<const LayerFilter *const> neighbors,
		std::span<const LayerFilter *const> measured, bool chooses_meshes) {
	// The rules are valid, so the call below can fail only for lack of memory.
	const GroundSides sides = layer.set.on_surface ? GroundSides::all : GroundSides::top;
	throw_if_out_of_memory(rules_.set(layer.rules, layer.set.seed, sides, layer.planet));
	layer_ = &layer;
	neighbors_.assign(neighbors.begin(), neighbors.end());
	measured_.assign(measured.begin(), measured.end());
	rule_sources_.clear();
	mesh_sources_.clear();
	textures_.clear();
	if (layer.rules.expression != nullptr) {
		for (const WorldInput &input : layer.rules.expression->world_inputs()) {
			rule_sources_.push_back(source_of(layer.world_sources, input));
		}
	}
	for (std::size_t source = 0; source < layer.world_sources.size(); ++source) {
		const WorldInput &input = layer.world_sources[source].input;
		const bool for_meshes = chooses_meshes && meshes_use(layer, input);
		const bool for_rules = std::ranges::find(rule_sources_, source) != rule_sources_.end();
		if (for_meshes) {
			mesh_sources_.push_back(source);
		}
		if (input.kind == WorldInputKind::texture && (for_meshes || for_rules)) {
			textures_.push_back({source, input.number, for_rules});
		}
	}
}

Status LayerFilter::sample(
		const PointSource &source, const TileSpace &window, const std::atomic<bool> *cancel, CallerThreads *threads) {
	window_ = window;
	on_surface_ = knows_ground_ = layer_->set.on_surface;
	is_filled_ = source.obstacles != nullptr;
	points_.clear();
	surface_points_.clear();
	bool is_closed = false;
	if (const Status status = rules_.find_closed(window, is_closed); !status.ok()) {
		return status;
	}
	if (!is_closed) { // If the rules let no point pass, none needs to be sampled.
		const Status status = on_surface_ ? sample_surface(source, cancel)
				: layer_->set.in_rows
				? sample_rows(cancel)
				: source.plane.sample(layer_->set, window, points_, {.cancel = cancel, .report = {}}, threads,
						  source.obstacles, source.use);
		if (!status.ok()) {
			return status;
		}
	}
	if (const Status status = query_position(); !status.ok()) {
		return status;
	}
	keep_points(false);
	return gather_surroundings(source.surface, cancel);
}

void LayerFilter::wait_for_others(const TileSpace &window) {
	window_ = window;
	on_surface_ = knows_ground_ = layer_->set.on_surface;
	sampled_count_ = 0;
	keep_points(true);
	accepted_.clear();
	thinning_ranks_.clear();
	probes_.clear();
	probe_allowed_.clear();
}

void LayerFilter::take_instances(std::span<const glm::dvec2> instances, const TileSpace &window) {
	wait_for_others(window);
	is_filled_ = false;
	positions_.assign(instances.begin(), instances.end());
	accepted_.resize(positions_.size());
	std::iota(accepted_.begin(), accepted_.end(), 0u);
}

void LayerFilter::take_points(std::span<const CachedPoint> points, std::size_t sampled, const TileSpace &window) {
	wait_for_others(window);
	is_filled_ = true;
	knows_ground_ = true;
	sampled_count_ = sampled;
	positions_.clear();
	ids_.clear();
	known_ground_.clear();
	for (const CachedPoint &point : points) {
		if (point.is_instance) {
			accepted_.push_back(static_cast<std::uint32_t>(positions_.size()));
			thinning_ranks_.push_back(point.thinning_rank);
		}
		positions_.push_back(point.position);
		ids_.push_back(point.id);
		known_ground_.push_back(point.ground);
	}
}

/// Finds the points of rows in the window.
Status LayerFilter::sample_rows(const std::atomic<bool> *cancel) {
	return layer_->rows != nullptr ? layer_->rows->sample(layer_->set, window_, points_, cancel) : Status();
}

/// Finds the points on the surface in the window, a column of space that may be limited in height.
Status LayerFilter::sample_surface(const PointSource &source, const std::atomic<bool> *cancel) {
	if (source.surface == nullptr || is_empty(source.surface->bounds())) {
		return {};
	}
	const PointSet &set = layer_->set;
	const Box3 &bounds = source.surface->bounds();
	// Beyond these limits, ids would repeat.
	const double extent = set_extent(set);
	const double height = extent / surface_id_extent * surface_id_height;
	const Status status = first_failure(check_range("rect", window_.min.x, -extent, extent),
			check_range("rect", window_.min.y, -extent, extent), check_range("rect", window_.max.x, -extent, extent),
			check_range("rect", window_.max.y, -extent, extent),
			check_range("height of the surface", bounds.min.y, -height, height),
			check_range("height of the surface", bounds.max.y, -height, height));
	if (!status.ok()) {
		return status;
	}
	const Planet &planet = layer_->planet;
	const double bottom =
			std::max({bounds.min.y - 1.0, window_.bottom, planet.exists() ? planet.bottom() : window_.bottom});
	const double top = std::min({bounds.max.y + 1.0, window_.top, planet.exists() ? planet.top() : window_.top});
	if (bottom >= top) {
		// The surface is above or below the window.
		return {};
	}
	const Box3 column{{window_.min.x, bottom, window_.min.y}, {window_.max.x, top, window_.max.y}};
	const Status sampled =
			source.surfaces.sample(set, *source.surface, column, surface_points_, {.cancel = cancel, .report = {}});
	for (const SurfacePoint &point : surface_points_) {
		points_.push_back({{point.position.x, point.position.z}, point.id, point.rank, point.level});
	}
	return sampled;
}

Status LayerFilter::take(std::span<const glm::dvec2> positions, const Rect &window, std::span<const Ground> on_surface,
		const Surface *host_surface) {
	window_ = window;
	on_surface_ = knows_ground_ = !on_surface.empty();
	is_filled_ = false;
	points_.clear();
	surface_points_.clear();
	for (const glm::dvec2 position : positions) {
		points_.push_back({.position = position, .id = points_.size(), .rank = 0, .level = 0});
	}
	for (std::size_t i = 0; i < on_surface.size(); ++i) {
		SurfacePoint point{};
		point.position = {positions[i].x, on_surface[i].height, positions[i].y};
		point.normal = on_surface[i].normal;
		surface_points_.push_back(point);
	}
	if (const Status status = query_position(); !status.ok()) {
		return status;
	}
	keep_points(true);
	return gather_surroundings(host_surface, nullptr);
}

/// Evaluates the position rules at all points.
Status LayerFilter::query_position() {
	sampled_count_ = points_.size();
	sampled_positions_.resize(sampled_count_);
	sampled_densities_.resize(sampled_count_);
	std::transform(points_.begin(), points_.end(), sampled_positions_.begin(),
			[](const SamplePoint &point) { return point.position; });
	sampled_heights_.clear();
	for (const SurfacePoint &point : surface_points_) {
		sampled_heights_.push_back(static_cast<float>(point.position.y));
	}
	return rules_.position_densities({sampled_positions_, sampled_heights_}, sampled_densities_, scratch_);
}

/// Splits the points into separate arrays: all of them, or only those that pass the position rules.
void LayerFilter::keep_points(bool all) {
	const auto resize = [this](std::size_t count) {
		positions_.resize(count);
		ids_.resize(count);
		ranks_.resize(count);
		densities_.resize(count);
		known_ground_.resize(on_surface_ ? count : 0);
	};
	resize(sampled_count_);
	// The loop avoids a branch, which would often be mispredicted: a point that is not kept is
	// overwritten by the next one.
	std::size_t kept_count = 0;
	for (std::size_t i = 0; i < sampled_count_; ++i) {
		positions_[kept_count] = points_[i].position;
		ids_[kept_count] = points_[i].id;
		ranks_[kept_count] = points_[i].rank;
		densities_[kept_count] = sampled_densities_[i];
		if (on_surface_) {
			const SurfacePoint &point = surface_points_[i];
			known_ground_[kept_count] = {sampled_heights_[i], glm::vec3(point.normal)};
		}
		kept_count += all || is_placed(points_[i].rank, sampled_densities_[i]) ? 1 : 0;
	}
	resize(kept_count);
}

Status LayerFilter::gather_surroundings(const Surface *host_surface, const std::atomic<bool> *cancel) {
	near_shapes_.clear();
	if (const ShapeSet *shapes = rules_.rules().shapes.get()) {
		// Probes may be outside the window.
		const double around = edge_reach(rules_.rules().edge_feather, on_surface_);
		throw_if_out_of_memory(shapes->find_nearby(expanded(window_, around), near_shapes_));
	}
	probes_.clear();
	probe_heights_.clear();
	probe_ground_.clear();
	probe_allowed_.clear();
	if (!(rules_.rules().edge_feather > 0.0)) {
		return {};
	}
	const Status status = find_probes(host_surface, cancel);
	return status.ok() ? evaluate_probes() : status;
}

Status LayerFilter::find_probes(const Surface *host_surface, const std::atomic<bool> *cancel) {
	if (on_surface_) {
		return host_surface != nullptr ? find_probes_on(*host_surface, cancel) : Status();
	}
	for (const glm::dvec2 position : positions_) {
		for (const glm::dvec2 offset : probe_offsets) {
			probes_.push_back(position + rules_.rules().edge_feather * offset);
		}
	}
	return {};
}

/// Finds the probes around the points on a surface, and the ground at each probe.
Status LayerFilter::find_probes_on(const Surface &host_surface, const std::atomic<bool> *cancel) {
	std::array<SurfaceProbe, edge_probes> around{};
	for (std::size_t point = 0; point < positions_.size(); ++point) {
		if (point % surface_points_per_check == 0 && is_cancelled(cancel)) {
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const Ground &ground = known_ground_[point];
		surface_probes_.find(host_surface, {positions_[point].x, ground.height, positions_[point].y}, ground.normal,
				rules_.rules().edge_feather, around);
		for (const SurfaceProbe &probe : around) {
			const auto height = static_cast<float>(probe.position.y);
			probes_.emplace_back(probe.position.x, probe.position.z);
			probe_heights_.push_back(height);
			probe_ground_.push_back(probe.on_surface ? Ground{height, glm::vec3(probe.normal)} : Ground());
		}
	}
	return {};
}

/// Evaluates the position rules at the probes.
Status LayerFilter::evaluate_probes() {
	sampled_densities_.resize(probes_.size());
	const Status status = rules_.position_densities({probes_, probe_heights_}, sampled_densities_, scratch_);
	probe_allowed_.resize(probes_.size());
	std::transform(sampled_densities_.begin(), sampled_densities_.end(), probe_allowed_.begin(),
			[](double density) { return density > 0.0; });
	return status;
}

void LayerFilter::add_queries(
		bool normals, std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const {
	if (!queries_ground()) {
		return;
	}
	const std::vector<std::int32_t> &textures = layer_->rules.ground_textures;
	const bool slope = rules_.needs_slope();
	if (knows_ground_) {
		add_known_queries(r_positions, r_queries);
	} else if (slope || !normals || probes_.empty()) {
		const std::size_t count = positions_.size() + probes_.size();
		r_queries.push_back({r_positions.size(), count, {textures, slope || normals}, {}, density_query()});
	} else {
		// Probes do not need normals.
		r_queries.push_back({r_positions.size(), positions_.size(), {textures, true}});
		r_queries.push_back({r_positions.size() + positions_.size(), probes_.size(), {textures, false}});
	}
	r_positions.insert(r_positions.end(), positions_.begin(), positions_.end());
	r_positions.insert(r_positions.end(), probes_.begin(), probes_.end());
	add_texture_queries(r_positions, r_queries);
}

/// Returns the index of the first position at which a texture is queried, among the positions of
/// add_queries.
std::size_t LayerFilter::texture_first(std::size_t index) const {
	std::size_t first = positions_.size() + probe_allowed_.size();
	for (const TextureWeights &texture : std::span(textures_).first(index)) {
		first += positions_.size() + (texture.at_probes ? probe_allowed_.size() : 0);
	}
	return first;
}

void LayerFilter::add_texture_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const {
	for (const TextureWeights &texture : textures_) {
		const std::size_t first = r_positions.size();
		r_positions.insert(r_positions.end(), positions_.begin(), positions_.end());
		if (texture.at_probes) {
			r_positions.insert(r_positions.end(), probes_.begin(), probes_.end());
		}
		const std::span<const std::int32_t> only(&texture.texture, 1);
		r_queries.push_back({first, r_positions.size() - first, {only, false}});
	}
}

/// Returns the weight of the texture of a source. `at` is the index of a point, or the number of points
/// plus the index of a probe.
float LayerFilter::texture_weight(std::size_t source, std::size_t at, std::span<const Ground> ground) const {
	const auto texture = std::ranges::find(textures_, source, &TextureWeights::source);
	return ground[texture_first(static_cast<std::size_t>(texture - textures_.begin())) + at].weight;
}

/// Returns the value of a source at a point or probe, whose index is as for texture_weight.
float LayerFilter::world_value(std::size_t source, std::size_t at, glm::dvec2 position, const Ground &point_ground,
		std::span<const Ground> ground) const {
	const WorldSource &from = layer_->world_sources[source];
	PositionBatch batch{{&position, 1}};
	if (on_surface_) {
		batch.heights = {&point_ground.height, 1};
	}
	float value = 0.0f;
	switch (from.input.kind) {
		case WorldInputKind::biome:
			if (from.biome != nullptr) {
				throw_if_out_of_memory(layer_->planet.exists()
								? from.biome->sample_on(layer_->planet, batch, {&value, 1})
								: from.biome->sample_at(batch, {&value, 1}));
			}
			break;
		case WorldInputKind::mask:
			if (from.mask != nullptr) {
				throw_if_out_of_memory(from.mask->sample_at(batch, {&value, 1}));
			}
			break;
		case WorldInputKind::texture: value = texture_weight(source, at, ground); break;
		case WorldInputKind::distance:
			value = static_cast<float>(from.input.max_distance);
			if (from.layer != nullptr && std::isfinite(point_ground.height)) {
				value = static_cast<float>(std::sqrt(
						nearest_squared(*measured_[source], position, point_ground, from.input.max_distance)));
			}
			break;
	}
	return value;
}

/// Writes the values of the world inputs of the rules' expression, and returns those that were
/// written.
std::span<const float> LayerFilter::rule_values(std::size_t at, glm::dvec2 position, const Ground &point_ground,
		std::span<const Ground> ground, WorldValues &r_values) const {
	for (std::size_t i = 0; i < rule_sources_.size(); ++i) {
		r_values[i] = world_value(rule_sources_[i], at, position, point_ground, ground);
	}
	return std::span<const float>(r_values).first(rule_sources_.size());
}

void LayerFilter::world_values(std::size_t point, std::span<const Ground> ground, std::span<float> r_values) const {
	for (const std::size_t source : mesh_sources_) {
		r_values[source] = world_value(source, point, positions_[point], ground_of(ground)[point], ground);
	}
}

DensityRuleQuery LayerFilter::density_query() const {
	return {layer_->rules.density_rules, on_surface_ ? GroundSides::all : GroundSides::top, layer_->planet};
}

/// Adds the queries for points on surfaces, whose ground is known.
void LayerFilter::add_known_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const {
	std::size_t first = r_positions.size();
	for (const std::span<const Ground> known : {std::span<const Ground>(known_ground_), std::span(probe_ground_)}) {
		r_queries.push_back({first, known.size(), {}, known, density_query()});
		first += known.size();
	}
}

bool LayerFilter::probe_allows(std::size_t probe, const Ground &point_ground, std::span<const Ground> ground) const {
	if (probe_allowed_[probe] == 0) {
		return false;
	}
	WorldValues values;
	const std::span<const float> world = rule_sources_.empty()
			? std::span<const float>()
			: rule_values(positions_.size() + probe, probes_[probe], point_ground, ground, values);
	return rules_.allow(point_ground, probes_[probe], world) &&
			rules_.shape_density(near_shapes_, probes_[probe], point_ground) > 0.0;
}

template <class Record>
double LayerFilter::edge_density_at(std::size_t point, std::span<const Ground> ground, const Record &record) const {
	const std::span<const Ground> probe_ground = probes_of(ground);
	std::size_t allowed_count = 0;
	for (std::size_t i = 0; i < edge_probes; ++i) {
		const std::size_t probe = point * edge_probes + i;
		allowed_count += probe_allows(probe, probe_ground[probe], ground) ? 1 : 0;
	}
	const double fraction = static_cast<double>(allowed_count) / static_cast<double>(edge_probes);
	return record(RuleKind::edge_feather, fraction, edge_density(allowed_count));
}

template <class Record>
double LayerFilter::neighbor_density(
		std::size_t neighbor, std::size_t point, const Ground &point_ground, const Record &record) const {
	const Neighbor &rule = layer_->neighbors[neighbor];
	const double squared = nearest_squared(*neighbors_[neighbor], positions_[point], point_ground, rule.distance);
	const double distance = Record::complete || rule.curve != nullptr ? std::sqrt(squared) : 0.0;
	const double density = rule.curve != nullptr      ? rule.curve->at(distance)
			: squared < rule.distance * rule.distance ? 0.0
													  : 1.0;
	return record(RuleKind::neighbor, distance, density, static_cast<std::uint32_t>(neighbor));
}

/// Returns the product of the rules that depend only on a point's position and the ground there.
template <class Record>
double LayerFilter::density_alone(
		std::size_t point, const Ground &point_ground, std::span<const Ground> ground, const Record &record) const {
	if (rule_sources_.empty()) {
		return densities_[point] * rules_.ground_density(point_ground, positions_[point], record);
	}
	WorldValues values;
	const std::span<const float> world = rule_values(point, positions_[point], point_ground, ground, values);
	return densities_[point] * rules_.ground_density(point_ground, positions_[point], record, world);
}

/// Evaluates the rules in ascending order of cost, and stops once the density is too low for the
/// point's rank.
template <class Record>
double LayerFilter::product(std::size_t point, std::span<const Ground> ground, const Record &record) const {
	const Ground &point_ground = ground_of(ground)[point];
	double density = density_alone(point, point_ground, ground, record);
	if (Record::complete && !std::isfinite(point_ground.height)) {
		return density; // The density is 0, and the remaining rules need ground.
	}
	const auto goes_on = [&] {
		return Record::complete || is_placed(ranks_[point], density);
	};
	if (goes_on()) {
		density *= rules_.shape_density(near_shapes_, positions_[point], point_ground, record);
	}
	for (std::size_t i = 0; i < neighbors_.size() && goes_on(); ++i) {
		if (!is_filled_ || !fills_around(*layer_, layer_->neighbors[i])) {
			density *= neighbor_density(i, point, point_ground, record);
		}
	}
	if (!probe_allowed_.empty() && goes_on()) {
		density *= edge_density_at(point, ground, record);
	}
	return density;
}

double LayerFilter::density_at(std::size_t point, std::span<const Ground> ground) const {
	return product(point, ground, NoRecord());
}

Status LayerFilter::factors_at(
		std::size_t point, std::span<const Ground> ground, std::vector<RuleFactor> &r_factors) const {
	std::vector<float> density_rules;
	Status status = density_query().find_each(positions_[point], ground_of(ground)[point], density_rules);
	const RuleRecord record(r_factors, density_rules);
	PositionBatch position{{&positions_[point], 1}};
	if (on_surface_) {
		position.heights = {&known_ground_[point].height, 1};
	}
	if (status.ok()) {
		status = rules_.position_factors(position, record);
	}
	if (status.ok()) {
		product(point, ground, record);
	}
	return status;
}

Status LayerFilter::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	const bool has_further_rules = rules_.rules().shapes != nullptr || !neighbors_.empty() || !probe_allowed_.empty();
	const std::span<const Ground> own_ground = ground_of(ground);
	accepted_.resize(positions_.size());
	thinning_ranks_.resize(positions_.size());
	std::size_t accepted = 0; // The loop avoids a branch, as in keep_points.
	for (std::size_t first = 0; first < positions_.size(); first += points_per_check) {
		if (is_cancelled(cancel)) {
			accepted_.clear();
			thinning_ranks_.clear();
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::size_t end = std::min(first + points_per_check, positions_.size());
		for (std::size_t point = first; point < end; ++point) {
			const double density = has_further_rules ? density_at(point, ground)
													 : density_alone(point, own_ground[point], ground, NoRecord());
			accepted_[accepted] = static_cast<std::uint32_t>(point);
			thinning_ranks_[accepted] = thinning_rank(ranks_[point], density);
			accepted += is_placed(ranks_[point], density) ? 1 : 0;
		}
	}
	accepted_.resize(accepted);
	thinning_ranks_.resize(accepted);
	return {};
}

void LayerFilter::index_present(const LayerGraph::Node &node, std::span<const Ground> ground, bool for_any_position) {
	const bool on_plane = node.needed_on_plane || (for_any_position && node.needed_for_filling);
	if (!on_plane && !node.needed_in_space) {
		return;
	}
	const double cell = std::max(node.max_dependent_distance, layer_->set.radius);
	present_positions_.clear();
	present_space_positions_.clear();
	for (const std::uint32_t point : accepted_) {
		const glm::dvec2 position = positions_[point];
		present_positions_.push_back(position);
		if (node.needed_in_space) {
			present_space_positions_.emplace_back(position.x, ground_of(ground)[point].height, position.y);
		}
	}
	if (on_plane) {
		grid_.set(present_positions_, window_, cell);
	}
	if (node.needed_in_space) {
		space_grid_.set(present_space_positions_, window_, cell);
	}
}

double LayerFilter::nearest_squared(
		const LayerFilter &other, glm::dvec2 position, const Ground &ground, double distance) const {
	return distance_in_space(*layer_, *other.layer_)
			? other.space_grid_.nearest_squared({position.x, ground.height, position.y}, distance)
			: other.grid_.nearest_squared(position, distance);
}

} // namespace thicket
