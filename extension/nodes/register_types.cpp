#include "nodes/register_types.hpp"

#include "nodes/biome/scatter_biome.hpp"
#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/sampler/poisson_points.hpp"
#include "nodes/sampler/poisson_sampler.hpp"
#include "nodes/sampler/poisson_surface_points.hpp"
#include "nodes/common/main_calls.hpp"
#include "nodes/common/precision.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/gameplay/scatter_instances.hpp"
#include "nodes/gameplay/scatter_request.hpp"
#include "nodes/gameplay/scatter_snapshot.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/impostor/scatter_impostor_baker.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/layer/scatter_mask.hpp"
#include "nodes/layer/scatter_rows.hpp"
#include "nodes/layer/scatter_rule.hpp"
#include "nodes/layer/scatter_tile_grid.hpp"
#include "nodes/layer/scatter_value_source.hpp"
#include "nodes/model/scatter_lod.hpp"
#include "nodes/model/scatter_model.hpp"
#include "nodes/region/scatter_region_3d.hpp"
#include "nodes/ground/former_grounds.hpp"
#include "nodes/ground/scatter_ground.hpp"
#include "nodes/ground/scatter_ground_colliders.hpp"
#include "nodes/ground/scatter_ground_combined.hpp"
#include "nodes/ground/scatter_ground_flat.hpp"
#include "nodes/ground/scatter_ground_heightmap.hpp"
#include "nodes/ground/scatter_ground_meshes.hpp"
#include "nodes/ground/scatter_ground_noise.hpp"
#include "nodes/ground/scatter_ground_node.hpp"
#include "nodes/explain/scatter_explanation.hpp"
#include "nodes/scatter/scatter_tile.hpp"
#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/defs.hpp>

using namespace godot;

namespace thicket {

void initialize(ModuleInitializationLevel p_level) {
	if (p_level != MODULE_INITIALIZATION_LEVEL_SCENE) {
		return;
	}
	remember_main_thread(); // The engine initializes libraries on its main thread.
	GDREGISTER_CLASS(PoissonPoints);
	GDREGISTER_CLASS(PoissonSurfacePoints);
	GDREGISTER_CLASS(PoissonSampler);
	GDREGISTER_CLASS(ScatterImpostorBaker);
	GDREGISTER_CLASS(ScatterGround);
	GDREGISTER_CLASS(ScatterGroundFlat);
	GDREGISTER_CLASS(ScatterGroundHeightmap);
	GDREGISTER_CLASS(ScatterGroundNoise);
	GDREGISTER_CLASS(ScatterGroundNode);
	GDREGISTER_CLASS(ScatterGroundMeshes);
	GDREGISTER_CLASS(ScatterGroundColliders);
	GDREGISTER_CLASS(ScatterGroundCombined);
	register_former_grounds();
	GDREGISTER_CLASS(ScatterMask);
	GDREGISTER_CLASS(ScatterDiffLimits);
	GDREGISTER_CLASS(ScatterState);
	GDREGISTER_CLASS(ScatterInstance);
	GDREGISTER_CLASS(ScatterInstances);
	GDREGISTER_CLASS(ScatterRequest);
	GDREGISTER_CLASS(ScatterSnapshot);
	GDREGISTER_CLASS(ScatterLod);
	GDREGISTER_CLASS(ScatterModel);
	GDREGISTER_CLASS(ScatterValueSource);
	GDREGISTER_CLASS(ScatterRule);
	GDREGISTER_CLASS(ScatterRows);
	GDREGISTER_CLASS(ScatterLayer);
	GDREGISTER_CLASS(ScatterTileGrid);
	GDREGISTER_CLASS(ScatterBiome);
	GDREGISTER_CLASS(ScatterBiomeMap);
	GDREGISTER_CLASS(ScatterRegion3D);
	GDREGISTER_CLASS(ScatterTile);
	GDREGISTER_CLASS(ScatterExplanation);
	GDREGISTER_CLASS(TerrainScatter3D);
}

void terminate(ModuleInitializationLevel) { drop_main_thread_calls(); }

} // namespace thicket

extern "C" {

/// The library's entry point; thicket.gdextension contains its name.
GDExtensionBool GDE_EXPORT thicket_library_init(GDExtensionInterfaceGetProcAddress p_get_proc_address,
		GDExtensionClassLibraryPtr p_library, GDExtensionInitialization *r_initialization) {
	if (!thicket::fits_precision(p_get_proc_address)) {
		return false;
	}
	const GDExtensionBinding::InitObject library(p_get_proc_address, p_library, r_initialization);
	library.register_initializer(thicket::initialize);
	library.register_terminator(thicket::terminate);
	library.set_minimum_library_initialization_level(MODULE_INITIALIZATION_LEVEL_SCENE);
	return library.init();
}
}
