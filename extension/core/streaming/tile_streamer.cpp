#include "core/streaming/tile_streamer.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/reserve.hpp"
#include "core/base/tile_grid.hpp"
#include "core/streaming/layer_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

/// Maximum distance of a viewer from the origin in tiles, so that all tiles around it have valid
/// coordinates.
constexpr double max_viewer_tiles = max_tile_coordinate - 2.0 * max_view_tiles;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Rect everywhere{glm::dvec2(-infinity), glm::dvec2(infinity)};

Status validate(const Viewer &viewer, std::span<const LayerTiles> layers) {
	double reach = max_viewer_tiles * max_tile_size;
	double height = std::numeric_limits<double>::max();
	for (const LayerTiles &layer : layers) {
		reach = std::min(reach, max_viewer_tiles * layer.settings().tile_size);
		height = layer.settings().in_space() ? std::min(height, reach) : height;
	}
	return first_failure(check_range("viewer.x", viewer.position.x, -reach, reach),
			check_range("viewer.y", viewer.position.y, -reach, reach),
			check_range("viewer.height", viewer.height, -height, height),
			check_range("viewer.radius_scale", viewer.radius_scale, 0.0, std::numeric_limits<double>::max()));
}

} // namespace

Status validate(const StreamLayer &layer) {
	static_assert(max_view_tiles == 64.0 && max_view_tiles_in_space == 16.0, "the notes below name them");
	return first_failure(check_positive("tile_size", layer.tile_size),
			check_range("tile_size", layer.tile_size, min_tile_size, max_tile_size),
			check_range("view_distance", layer.view_distance,
					between(0.0, layer.view_tile_limit() * layer.tile_size,
							layer.in_space() ? "16 x tile_size on a planet" : "64 x tile_size"),
					"Increase tile_size or lower view_distance"));
}

bool StreamLayer::may_have_ground(const TileSpace &space) const {
	if (!in_space()) {
		return true;
	}
	const auto farther = [](double min, double max, double from) {
		return std::max(std::abs(min - from), std::abs(max - from));
	};
	const double x = farther(space.min.x, space.max.x, center.x);
	const double y = farther(space.bottom, space.top, center.y);
	const double z = farther(space.min.y, space.max.y, center.z);
	return distance_squared(space, center) <= farthest * farthest && nearest * nearest <= x * x + y * y + z * z &&
			nearest <= farthest;
}

struct TileStreamer::State {
	std::vector<LayerTiles> layers;
	std::vector<TrackedViewer> viewers;
	bool outdated = true;  ///< True if some layers have not been checked for all viewers yet.
	bool answered = false; ///< True if a tile was finished since the last check of retired tiles.
	StreamChanges backlog; ///< Changes recorded between updates.
	std::uint32_t last_grid = 0;
	std::uint64_t last_ticket = 0;
	std::size_t first_layer = 0;            ///< Layer that the next update checks first.
	std::size_t last_requesting_viewer = 0; ///< Viewer that last had its turn to request a tile.
	std::size_t last_shown_viewer = 0;      ///< Viewer that last had its turn to show a tile.

	void reserve_changes(std::size_t layer_count);
	std::optional<TileRequest> next_ready();
	void track(std::span<const Viewer> now);
	void update_layers(StreamChanges &r_changes);
	std::size_t count_waiting_tiles();
	bool request_one(std::size_t viewer, StreamChanges &r_changes);
	void request(std::size_t max_pending, StreamChanges &r_changes);
};

void StreamChanges::clear() {
	cancel.clear();
	drop.clear();
	request.clear();
}

/// Allocates the memory for `layer_count` layers and for new settings of the existing ones.
void TileStreamer::State::reserve_changes(std::size_t layer_count) {
	std::size_t cancel = 0;
	std::size_t drop = 0;
	for (LayerTiles &layer : layers) {
		layer.add_max_changes(cancel, drop);
		layer.reserve_retired();
	}
	reserve_more(backlog.cancel, cancel);
	reserve_more(backlog.drop, drop);
	layers.reserve(layer_count);
}

/// Updates the viewers' positions. Viewers are matched by index; if their number has changed, all
/// of them are treated as having jumped.
void TileStreamer::State::track(std::span<const Viewer> now) {
	double farthest = 0.0;
	for (const TrackedViewer &viewer : viewers) {
		farthest = std::max(farthest, viewer.traveled);
	}
	const bool others = now.size() != viewers.size();
	const bool in_space =
			std::ranges::any_of(layers, [](const LayerTiles &each) { return each.settings().in_space(); });
	viewers.resize(now.size());
	for (std::size_t i = 0; i < now.size(); ++i) {
		TrackedViewer &viewer = viewers[i];
		const glm::dvec2 step = now[i].position - viewer.now.position;
		const double rise = in_space ? now[i].height - viewer.now.height : 0.0;
		const double length = std::sqrt(step.x * step.x + step.y * step.y + rise * rise);
		viewer.now = now[i];
		if (others) {
			viewer.traveled = viewer.last_jump = farthest + 1.0;
		} else if (length > max_flight_step) {
			viewer.last_jump = ++viewer.traveled;
		} else {
			viewer.traveled += length;
		}
	}
}

/// Checks the layers for all viewers, starting with those that the last update did not complete.
void TileStreamer::State::update_layers(StreamChanges &r_changes) {
	std::size_t found = 0;
	outdated = true; // Reset when this function completes.
	bool behind = false;
	const std::size_t first = first_layer;
	for (std::size_t offset = 0; offset < layers.size(); ++offset) {
		const std::size_t index = (first + offset) % layers.size();
		LayerTiles &layer = layers[index];
		const bool updated = layer.update_viewers(viewers, found, r_changes);
		if (layer.behind()) {
			first_layer = behind ? first_layer : index;
			behind = true;
		}
		if (!layer.has_retired() || layer.behind()) {
			continue;
		}
		if (!updated && !answered) {
			// Nothing has changed since the last check, so the same tiles are missing under retired
			// ones.
			continue;
		}
		layer.drop_covered(r_changes);
	}
	answered = false;
	outdated = behind;
}

/// Returns the number of ready tiles that wait for nearer tiles.
std::size_t TileStreamer::State::count_waiting_tiles() {
	std::size_t sum = 0;
	for (LayerTiles &layer : layers) {
		sum += layer.count_waiting(viewers);
	}
	return sum;
}

/// Requests the waiting tile of any layer that is nearest to a viewer. Returns false if there is
/// none.
bool TileStreamer::State::request_one(std::size_t viewer, StreamChanges &r_changes) {
	LayerTiles *nearest_layer = nullptr;
	LayerTiles::Candidate nearest;
	for (LayerTiles &layer : layers) {
		const auto next = layer.next_waiting(viewer);
		if (next && (nearest_layer == nullptr || next->distance_squared < nearest.distance_squared)) {
			nearest_layer = &layer;
			nearest = *next;
		}
	}
	if (nearest_layer == nullptr) {
		return false;
	}
	reserve_more(r_changes.request, 1);
	r_changes.request.push_back(nearest_layer->request(
			nearest.slot, ++last_ticket, static_cast<std::uint32_t>(viewer), viewers[viewer].traveled));
	return true;
}

void TileStreamer::State::request(std::size_t max_pending, StreamChanges &r_changes) {
	std::size_t waiting = 0;
	std::size_t pending = 0;
	for (const LayerTiles &layer : layers) {
		waiting += layer.counts().waiting;
		pending += layer.counts().pending;
	}
	if (waiting > 0 && pending >= max_pending) {
		pending -= count_waiting_tiles(); // Ready tiles must not delay the tiles for which they wait.
	}
	std::size_t in_vain = 0; // Number of consecutive viewers with no tile to request.
	while (pending < max_pending && in_vain < viewers.size()) {
		last_requesting_viewer = (last_requesting_viewer + 1) % viewers.size();
		const bool requested = request_one(last_requesting_viewer, r_changes);
		pending += requested ? 1 : 0;
		in_vain = requested ? 0 : in_vain + 1;
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
	const auto count = static_cast<double>(settings.size());
	if (const Status status = guarded("layers", count, [&] { state_->reserve_changes(settings.size()); });
			!status.ok()) {
		return status;
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
	state_->outdated = true;
	return {};
}

void TileStreamer::invalidate(std::uint32_t layer) { invalidate(layer, everywhere); }

void TileStreamer::invalidate(std::uint32_t layer, const Rect &area) {
	if (layer < state_->layers.size()) {
		state_->layers[layer].invalidate(area);
	}
}

void TileStreamer::drop_unseen(const Rect &area) {
	for (LayerTiles &layer : state_->layers) {
		static_cast<void>(guarded("tiles", 1.0, [&] { layer.drop_unseen(area, state_->backlog); }));
	}
}

void TileStreamer::cancel(std::uint32_t layer) {
	if (layer < state_->layers.size()) {
		state_->layers[layer].cancel_all(state_->backlog);
		// Canceled tiles out of view are removed, so retired tiles may be covered now.
		state_->answered = true;
	}
}

Status TileStreamer::check(const Viewer &viewer) const { return validate(viewer, state_->layers); }

Status TileStreamer::update(std::span<const Viewer> viewers, std::size_t max_pending, StreamChanges &r_changes) {
	State &state = *state_;
	for (const Viewer &viewer : viewers) {
		if (const Status status = check(viewer); !status.ok()) {
			return status;
		}
	}
	r_changes.clear();
	std::swap(r_changes, state.backlog);
	return guarded("viewers", static_cast<double>(viewers.size()), [&] {
		state.track(viewers);
		state.update_layers(r_changes);
		state.request(max_pending, r_changes);
	});
}

bool TileStreamer::ready(const TileRequest &request) {
	return request.key.layer < state_->layers.size() && state_->layers[request.key.layer].ready(request);
}

std::optional<TileRequest> TileStreamer::next_ready() {
	std::optional<TileRequest> found;
	const Status status = guarded("tiles", 1.0, [&] { found = state_->next_ready(); });
	return status.ok() ? found : std::nullopt;
}

std::optional<TileRequest> TileStreamer::State::next_ready() {
	if (std::ranges::none_of(layers, [](const LayerTiles &layer) { return layer.ready_count() > 0; })) {
		// No tile is ready.
		return std::nullopt;
	}
	const std::size_t count = viewers.size();
	for (std::size_t offset = 1; offset <= count; ++offset) {
		const std::size_t viewer = (last_shown_viewer + offset) % count;
		LayerTiles *nearest_layer = nullptr;
		LayerTiles::Candidate nearest;
		for (LayerTiles &layer : layers) {
			const auto next = layer.next_ready(viewer, viewers[viewer]);
			if (next && (nearest_layer == nullptr || next->distance_squared < nearest.distance_squared)) {
				nearest_layer = &layer;
				nearest = *next;
			}
		}
		if (nearest_layer != nullptr) {
			last_shown_viewer = viewer;
			return nearest_layer->request_of(nearest.slot);
		}
	}
	return std::nullopt;
}

bool TileStreamer::may_show(const TileRequest &request) {
	bool may = false;
	const Status status = guarded("tiles", 1.0, [&] {
		may = request.key.layer < state_->layers.size() &&
				state_->layers[request.key.layer].may_show(request, state_->viewers);
	});
	return status.ok() && may;
}

bool TileStreamer::finish(const TileRequest &request) {
	if (request.key.layer >= state_->layers.size()) {
		return false;
	}
	const bool accepted = state_->layers[request.key.layer].finish(request);
	state_->answered = state_->answered || accepted;
	return accepted;
}

void TileStreamer::clear() {
	for (LayerTiles &layer : state_->layers) {
		layer.forget();
	}
	state_->backlog.clear();
	state_->outdated = true;
}

StreamCounts TileStreamer::counts() const {
	StreamCounts sum;
	for (const LayerTiles &layer : state_->layers) {
		const StreamCounts counts = layer.counts();
		sum.waiting += counts.waiting;
		sum.pending += counts.pending;
		sum.visible += counts.visible;
	}
	return sum;
}

bool TileStreamer::idle() const {
	const bool settled = std::ranges::all_of(state_->layers, [](const LayerTiles &layer) {
		const StreamCounts counts = layer.counts();
		return counts.waiting == 0 && counts.pending == 0 && !layer.has_retired();
	});
	return settled && !state_->outdated && state_->backlog.empty();
}

bool TileStreamer::follows(std::span<const Viewer> viewers) const {
	return std::ranges::all_of(state_->layers, [viewers](const LayerTiles &layer) { return layer.follows(viewers); });
}

} // namespace thicket
