#include "nodes/scatter/tile_display.hpp"

#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The mesh near by, then those for the distance, none of them null.
std::vector<Ref<Mesh>> lods_of(const LayerDrawing &drawing, std::size_t mesh) {
	std::vector<Ref<Mesh>> lods{drawing.meshes[mesh]};
	for (std::size_t at = mesh; at < drawing.lod_meshes.size(); at += drawing.meshes.size()) {
		lods.push_back(drawing.lod_meshes[at].is_valid() ? drawing.lod_meshes[at] : lods.back());
	}
	return lods;
}

} // namespace

TileDisplay::Order TileDisplay::order(const TileKey &key) {
	return {key.layer, key.tile.x, key.tile.y, -std::int64_t{key.grid}};
}

TileKey TileDisplay::key_of(const Order &order) {
	const auto &[layer, x, y, grid] = order;
	return {layer, static_cast<std::uint32_t>(-grid), {x, y}};
}

void TileDisplay::set_scenario(const RID &scenario, std::uint64_t node_id) {
	context_.scenario = scenario;
	context_.node_id = node_id;
}

void TileDisplay::set_world_offset(glm::dvec3 offset) {
	context_.offset = offset;
	for (auto &[key, tile] : tiles_) {
		tile.set_offset(offset);
	}
	for (TileVisual &visual : leaving_) {
		visual.set_offset(offset);
	}
}

void TileDisplay::set_visible(bool visible) {
	if (visible_ == visible) {
		return;
	}
	visible_ = visible;
	for (auto &[key, tile] : tiles_) {
		tile.set_visible(visible);
	}
}

void TileDisplay::set_layers(const std::vector<SharedSnapshot> &layers) {
	drawing_versions_.resize(layers.size());
	bool changed = false;
	for (std::size_t index = 0; index < layers.size(); ++index) {
		const SharedSnapshot before = index < layers_.size() ? layers_[index] : nullptr;
		const SharedSnapshot &now = layers[index];
		const bool same =
				before != nullptr && now != nullptr && before->drawing == now->drawing && before->lod == now->lod;
		if (before != now && !same) {
			drawing_versions_[index] = ++last_version_;
			changed = true;
		}
	}
	layers_ = layers;
	if (changed) {
		visit_all();
	}
}

/// Null for a layer of which nothing is shown.
const LayerSnapshot *TileDisplay::layer_at(std::uint32_t index) const {
	return index < layers_.size() ? layers_[index].get() : nullptr;
}

std::uint64_t TileDisplay::drawing_version(std::uint32_t layer) const {
	return layer < drawing_versions_.size() ? drawing_versions_[layer] : 0;
}

void TileDisplay::draw_part(const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing,
		const MeshUpload &upload, DisplayedTile::Part &r_part) {
	VisualContext context = context_;
	context.origin = tile.tile->origin;
	r_part.lods = lods_of(drawing, mesh);
	r_part.visual.emplace(context, tile.settings->look, drawing.meshes[mesh], upload);
	r_part.visual->apply(drawing);
	++upload_count_;
}

void TileDisplay::begin(TileUpload &r_upload) const {
	static const auto nothing = std::make_shared<const TileInstances>();
	const TileJob &job = *r_upload.job;
	DisplayedTile &tile = r_upload.tile;
	tile.tile = job.tile != nullptr ? job.tile : nothing; // One that could not be made is empty.
	tile.settings = job.layer->settings;
	tile.mesh_reach = job.layer->drawing.mesh_reach;
	tile.rect = job.request.rect;
	tile.drawing_version = drawing_version(job.request.key.layer);
	r_upload.shown = overlay(tile);
	r_upload.overlay_version = overlay_version_;
}

void TileDisplay::upload_part(TileUpload &r_upload) {
	if (!r_upload.is_begun()) {
		begin(r_upload);
	}
	if (r_upload.is_complete()) {
		return;
	}
	const TileJob &job = *r_upload.job;
	DisplayedTile &tile = r_upload.tile;
	const std::size_t mesh = tile.parts.size();
	DisplayedTile::Part part;
	part.shown = r_upload.shown[mesh];
	const LayerSnapshot *layer = layer_at(job.request.key.layer);
	if (layer != nullptr && layer->drawing.draws(mesh) && part.shown->size() > 0) {
		const bool own = part.shown.get() == &job.tile->meshes[mesh];
		const MeshUpload upload = own ? job.uploads[mesh] : to_upload(*part.shown, tile.reach_of(mesh));
		draw_part(tile, mesh, layer->drawing, upload, part);
		tile.grow(upload.aabb);
	}
	tile.parts.push_back(std::move(part));
}

void TileDisplay::show(TileUpload upload) {
	const TileKey key = upload.job->request.key;
	DisplayedTile &tile = tiles_[order(key)];
	uncount(tile);
	upload.tile.lod = tile.lod;
	upload.tile.is_cut = tile.is_cut;
	// The old visuals go now: for as long as both were visible, each instance would be drawn twice.
	tile = std::move(upload.tile);
	if (upload.overlay_version != overlay_version_) {
		patch(key, tile);
	}
	tile.set_offset(context_.offset); // The origin may have moved since the first part was uploaded.
	count(tile);
	refine(key, tile);
	tile.set_visible(visible_);
}

void TileDisplay::leave(DisplayedTile &&tile) {
	for (DisplayedTile::Part &part : tile.parts) {
		if (part.visual) {
			leaving_.push_back(std::move(*part.visual));
		}
	}
}

bool TileDisplay::holds(const TileKey &key) const { return tiles_.contains(order(key)); }

bool TileDisplay::drop(const TileKey &key) {
	const auto found = tiles_.find(order(key));
	if (found == tiles_.end()) {
		return false;
	}
	uncount(found->second);
	leave(std::move(found->second));
	tiles_.erase(found);
	schedule_.remove(key);
	return true;
}

bool TileDisplay::free_step() {
	if (leaving_.empty()) {
		return false;
	}
	leaving_.pop_back();
	return true;
}

void TileDisplay::clear() {
	leaving_.clear();
	tiles_.clear();
	instances_ = drawn_ = wanted_ = upload_count_ = redrawn_count_ = 0;
	schedule_.clear();
	cut_.clear();
	share_ = 1.0;
	hidden_.clear();
	marks_.clear();
	marked_all_ = false;
	marked_later_.clear();
}

const DisplayedTile *TileDisplay::find(std::uint32_t layer, glm::ivec2 tile) const {
	const auto found = tiles_.lower_bound({layer, tile.x, tile.y, std::numeric_limits<std::int64_t>::min()});
	if (found == tiles_.end()) {
		return nullptr;
	}
	const auto &[at_layer, x, y, grid] = found->first;
	return at_layer == layer && x == tile.x && y == tile.y ? &found->second : nullptr;
}

std::vector<glm::ivec2> TileDisplay::tiles(std::uint32_t layer) const {
	constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
	std::vector<glm::ivec2> result;
	auto at = tiles_.lower_bound({layer, lowest, lowest, std::numeric_limits<std::int64_t>::min()});
	for (; at != tiles_.end() && std::get<0>(at->first) == layer; ++at) {
		result.emplace_back(std::get<1>(at->first), std::get<2>(at->first));
	}
	return result;
}

} // namespace thicket
