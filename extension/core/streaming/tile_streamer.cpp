#include "core/streaming/tile_streamer.hpp"

#include "core/base/check.hpp"
#include "core/streaming/layer_tiles.hpp"
#include "core/base/tile_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

/// Tiles that a viewer may stand from the origin: what it sees and what is kept behind that still have coordinates.
constexpr double max_viewer_tiles = max_tile_coordinate - 2.0 * max_view_tiles;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Rect everywhere{glm::dvec2(-infinity), glm::dvec2(infinity)};

Status validate(const StreamLayer &layer) {
	return first_failure(check_positive("tile_size", layer.tile_size),
			check_range("tile_size", layer.tile_size, min_tile_size, max_tile_size),
			check_range("view_distance", layer.view_distance, 0.0, max_view_tiles * layer.tile_size));
}

Status validate(const Viewer &viewer, std::span<const LayerTiles> layers) {
	double reach = max_viewer_tiles * max_tile_size;
	double scale = std::numeric_limits<double>::max();
	for (const LayerTiles &layer : layers) {
		const StreamLayer &settings = layer.settings();
		reach = std::min(reach, max_viewer_tiles * settings.tile_size);
		scale = std::min(scale, max_view_tiles * settings.tile_size / settings.view_distance);
	}
	return first_failure(check_range("viewer.x", viewer.position.x, -reach, reach),
			check_range("viewer.y", viewer.position.y, -reach, reach),
			check_range("viewer.radius_scale", viewer.radius_scale, 0.0, scale));
}

/// A heap's order: the nearest tile on top, and no two tiles equal.
bool later(const LayerTiles::Waiting &a, const LayerTiles::Waiting &b) {
	if (a.distance_squared != b.distance_squared) {
		return a.distance_squared > b.distance_squared;
	}
	if (a.layer != b.layer) {
		return a.layer > b.layer;
	}
	return a.tile.y != b.tile.y ? a.tile.y > b.tile.y : a.tile.x > b.tile.x;
}

} // namespace

struct TileStreamer::State {
	std::vector<LayerTiles> layers;
	std::vector<LayerTiles::Waiting> waiting; ///< A heap under `later`; of no use while `waiting_outdated`.
	bool waiting_outdated = true;
	bool answered = false; ///< Something was finished since retired tiles were last looked at.
	StreamChanges backlog; ///< What came up between updates.
	std::uint32_t last_grid = 0;
	std::uint64_t last_ticket = 0;

	std::size_t pending() const;
	void request(std::size_t max_pending, StreamChanges &r_changes);
};

void StreamChanges::clear() {
	cancel.clear();
	drop.clear();
	request.clear();
}

std::size_t TileStreamer::State::pending() const {
	std::size_t sum = 0;
	for (const LayerTiles &layer : layers) {
		sum += layer.pending();
	}
	return sum;
}

void TileStreamer::State::request(std::size_t max_pending, StreamChanges &r_changes) {
	if (waiting_outdated) {
		waiting.clear();
		for (const LayerTiles &layer : layers) {
			layer.add_waiting(waiting);
		}
		std::ranges::make_heap(waiting, later);
		waiting_outdated = false;
	}
	for (std::size_t count = pending(); count < max_pending && !waiting.empty(); ++count) {
		std::ranges::pop_heap(waiting, later);
		const LayerTiles::Waiting next = waiting.back();
		waiting.pop_back();
		r_changes.request.push_back(layers[next.layer].request(next.tile, ++last_ticket));
	}
}

TileStreamer::TileStreamer() : state_(std::make_unique<State>()) {}
TileStreamer::~TileStreamer() = default;
TileStreamer::TileStreamer(TileStreamer &&) noexcept = default;
TileStreamer &TileStreamer::operator=(TileStreamer &&) noexcept = default;

Status TileStreamer::set_layers(std::span<const StreamLayer> settings) {
	for (const StreamLayer &layer : settings) {
		if (const Status status = validate(layer); !status.ok()) {
			return status;
		}
	}
	std::vector<LayerTiles> &layers = state_->layers;
	for (std::size_t i = settings.size(); i < layers.size(); ++i) {
		layers[i].clear(state_->backlog);
	}
	layers.erase(layers.begin() + static_cast<std::ptrdiff_t>(std::min(settings.size(), layers.size())), layers.end());
	for (std::size_t i = 0; i < settings.size(); ++i) {
		const std::uint32_t new_grid = ++state_->last_grid;
		if (i < layers.size()) {
			layers[i].configure(settings[i], new_grid, state_->backlog);
		} else {
			layers.emplace_back(static_cast<std::uint32_t>(i), settings[i], new_grid);
		}
	}
	state_->waiting_outdated = true;
	return {};
}

void TileStreamer::invalidate(std::uint32_t layer) { invalidate(layer, everywhere); }

void TileStreamer::invalidate(std::uint32_t layer, const Rect &area) {
	if (layer < state_->layers.size()) {
		state_->layers[layer].invalidate(area);
		state_->waiting_outdated = true;
	}
}

void TileStreamer::cancel(std::uint32_t layer) {
	if (layer < state_->layers.size()) {
		state_->layers[layer].cancel_all(state_->backlog);
		state_->waiting_outdated = true;
	}
}

Status TileStreamer::update(std::span<const Viewer> viewers, std::size_t max_pending, StreamChanges &r_changes) {
	State &state = *state_;
	if (viewers.size() > max_viewers) {
		return {ErrorCode::out_of_range, "viewers", static_cast<double>(viewers.size())};
	}
	for (const Viewer &viewer : viewers) {
		if (const Status status = validate(viewer, state.layers); !status.ok()) {
			return status;
		}
	}
	r_changes.clear();
	std::swap(r_changes, state.backlog);
	for (LayerTiles &layer : state.layers) {
		const bool looked = layer.look(viewers, r_changes);
		state.waiting_outdated = state.waiting_outdated || looked;
		if (layer.has_retired() && (looked || state.answered)) {
			layer.drop_covered(r_changes);
		}
	}
	state.answered = false;
	state.request(max_pending, r_changes);
	return {};
}

bool TileStreamer::finish(const TileRequest &request) {
	if (request.key.layer >= state_->layers.size()) {
		return false;
	}
	bool again = false;
	const bool accepted = state_->layers[request.key.layer].finish(request, again);
	state_->answered = state_->answered || accepted;
	state_->waiting_outdated = state_->waiting_outdated || again;
	return accepted;
}

void TileStreamer::clear() {
	StreamChanges forgotten;
	for (LayerTiles &layer : state_->layers) {
		layer.clear(forgotten);
	}
	state_->backlog.clear();
	state_->waiting_outdated = true;
}

StreamCounts TileStreamer::counts() const {
	StreamCounts counts;
	for (const LayerTiles &layer : state_->layers) {
		layer.count(counts);
	}
	return counts;
}

bool TileStreamer::idle() const {
	const bool retired = std::ranges::any_of(state_->layers, &LayerTiles::has_retired);
	return !state_->waiting_outdated && state_->waiting.empty() && state_->backlog.empty() && state_->pending() == 0 &&
			!retired;
}

} // namespace thicket
