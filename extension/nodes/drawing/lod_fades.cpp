#include "nodes/drawing/lod_fades.hpp"

#include "nodes/model/mesh_merge.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

std::size_t variant_of(bool comes, LodEnd end) { return (comes ? 3 : 0) + static_cast<std::size_t>(end); }

bool same_look(const MeshLook &a, const MeshLook &b) { return a.same_meshes(b) && a.look == b.look; }

/// A mesh for each of the ranges: the original mesh if nothing fades, or if it has no surface.
std::vector<Ref<Mesh>> faded(const Ref<Mesh> &mesh, std::span<const FadeRange> ranges) {
	std::vector<FadeRange> needed;
	std::ranges::copy_if(ranges, std::back_inserter(needed), [](const FadeRange &range) { return range != no_fade; });
	const std::vector<Ref<Mesh>> made = mesh.is_valid() ? faded_meshes(mesh, needed) : std::vector<Ref<Mesh>>();
	std::vector<Ref<Mesh>> result;
	for (std::size_t next = 0; const FadeRange &range : ranges) {
		const bool is_made = range != no_fade && next < made.size() && made[next].is_valid();
		result.push_back(is_made ? made[next] : mesh);
		next += range != no_fade ? 1 : 0;
	}
	return result;
}

} // namespace

std::vector<MeshLook> lods_of(const LayerDrawing &drawing, std::size_t mesh) {
	std::vector<MeshLook> lods{drawing.meshes[mesh]};
	for (std::size_t at = mesh; at < drawing.lod_meshes.size(); at += drawing.meshes.size()) {
		const MeshLook &next = drawing.lod_meshes[at];
		lods.push_back(next.mesh.is_valid() ? next : lods.back());
	}
	return lods;
}

LodChain::LodChain(const LayerDrawing &drawing, const LodSettings &lod, std::size_t mesh) :
		settings_(lod), surfaces_(drawing.surfaces) {
	if (!drawing.draws(mesh)) {
		return;
	}
	for (const MeshLook &look : lods_of(drawing, mesh)) {
		const bool same = !looks_.empty() && same_look(look, looks_.back().plain);
		const std::size_t index = steps_.size();
		steps_when_made_.push_back({same, look.fades});
		steps_.push_back({same, false});
		if (same) {
			looks_.back().last = index;
		} else {
			looks_.push_back({index, index, look, {}});
		}
		look_of_.push_back(looks_.size() - 1);
	}
	const bool any = settings_.fade > 0.0 && std::ranges::any_of(steps_when_made_, &LodStep::fades);
	made_ = any ? 0 : looks_.size();
}

/// All ranges that the look may be drawn with, by variant.
std::vector<FadeRange> LodChain::ranges_of(const Look &look) const {
	std::vector<FadeRange> ranges;
	for (const bool comes : {false, true}) {
		for (const LodEnd end : {LodEnd::stays, LodEnd::next, LodEnd::sight}) {
			const bool may_come = !comes || look.first > 0;
			const bool may_go = end == LodEnd::stays || (end == LodEnd::next && look.last + 1 < steps_.size()) ||
					(end == LodEnd::sight && settings_.sight_end > 0.0);
			ranges.push_back(may_come && may_go ? fade_range(settings_, look.first, look.last, comes, end) : no_fade);
		}
	}
	return ranges;
}

void LodChain::make_next(const LodChain *before) {
	Look &look = looks_[made_];
	const std::vector<FadeRange> ranges = ranges_of(look);
	const auto is_same = [&](const Look &other) {
		return same_look(other.plain, look.plain) && before->ranges_of(other) == ranges;
	};
	const Look *known = nullptr;
	if (before != nullptr && before->is_made() && before->surfaces_ == surfaces_) {
		const auto found = std::ranges::find_if(before->looks_, is_same);
		known = found != before->looks_.end() ? &*found : nullptr;
	}
	if (known != nullptr) {
		// Fast path: existing copies of the mesh fade over the same distances.
		look.faded = known->faded;
	} else if (look.plain.fades) {
		const std::vector<Ref<Mesh>> meshes = faded(look.plain.mesh, ranges);
		const std::vector<Ref<Mesh>> shadows = faded(look.plain.shadow.mesh, ranges);
		for (std::size_t variant = 0; variant < variants; ++variant) {
			look.faded[variant] = {
					meshes[variant], {shadows[variant], look.plain.shadow.setting}, look.plain.look, true};
		}
	} else {
		look.faded.fill(look.plain);
	}
	if (++made_ == looks_.size()) {
		steps_ = steps_when_made_;
	}
}

bool LodChain::is_of(std::span<const MeshLook> lods) const {
	if (lods.size() != look_of_.size()) {
		return false;
	}
	for (std::size_t lod = 0; lod < lods.size(); ++lod) {
		if (!same_look(lods[lod], looks_[look_of_[lod]].plain)) {
			return false;
		}
	}
	return true;
}

const MeshLook &LodChain::look(const LodSpan &span, std::size_t index) const {
	const Look &look = looks_[look_of_[span.first] + index];
	const bool comes = index > 0;
	const LodEnd end = look_of_[span.first] + index < look_of_[span.last] ? LodEnd::next
			: span.ends                                                   ? LodEnd::sight
																		  : LodEnd::stays;
	const bool fades = is_made() && (comes || end != LodEnd::stays) && look.plain.fades;
	return fades ? look.faded[variant_of(comes, end)] : look.plain;
}

const MeshLook &LodChain::only_look(const LodSpan &span, std::size_t lod) const {
	const Look &look = looks_[look_of_[std::min(lod, look_of_.size() - 1)]];
	const bool fades = is_made() && span.ends && look.plain.fades;
	return fades ? look.faded[variant_of(false, LodEnd::sight)] : look.plain;
}

void LodFades::set_layers(std::span<const SharedSnapshot> layers) {
	layers_.resize(layers.size());
	for (std::size_t index = 0; index < layers.size(); ++index) {
		Layer &layer = layers_[index];
		const SharedSnapshot &now = layers[index];
		const bool same =
				layer.of != nullptr && now != nullptr && layer.of->drawing == now->drawing && layer.of->lod == now->lod;
		if (!same) {
			layer.before = std::exchange(layer.chains, {});
			for (std::size_t mesh = 0; now != nullptr && mesh < now->drawing.meshes.size(); ++mesh) {
				layer.chains.emplace_back(now->drawing, now->lod, mesh);
			}
		}
		layer.of = now;
	}
	layers_made_ = 0;
}

const LodChain *LodFades::find(std::uint32_t layer, std::size_t mesh) const {
	const bool known = layer < layers_.size() && mesh < layers_[layer].chains.size();
	return known ? &layers_[layer].chains[mesh] : nullptr;
}

bool LodFades::make_some(bool &r_ready) {
	for (; layers_made_ < layers_.size(); ++layers_made_) {
		Layer &layer = layers_[layers_made_];
		for (std::size_t mesh = 0; mesh < layer.chains.size(); ++mesh) {
			LodChain &chain = layer.chains[mesh];
			if (!chain.is_made()) {
				chain.make_next(mesh < layer.before.size() ? &layer.before[mesh] : nullptr);
				r_ready = chain.is_made();
				return true;
			}
		}
		layer.before.clear();
	}
	return false;
}

} // namespace thicket
