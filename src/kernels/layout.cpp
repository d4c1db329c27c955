// Writes what a block of pixels sees (layout.h).
#include "kernels/layout.h"

#include "kernels/facet.h"
#include "kernels/lanes.h"
#include "kernels/octahedral.h"
#include "kernels/tables.h"

namespace vitral {
namespace VITRAL_ISA {
namespace {

[[gnu::always_inline]] inline Vec3T<Float> geometric_normal(const Facet<Float, Mask>& f,
                                                            const Vec3T<Float>& direction, Mask seen) {
  return flip_where(looks_away_along(f.normal, direction, seen), f.normal);
}

// The shading normal as kernels/surface.cpp has it.
[[gnu::always_inline]] inline Vec3T<Float> normal_at(const Facet<Float, Mask>& f, const VisiblePoint& p,
                                                     const Vec3T<Float>& direction, Mask seen) {
  const Vec3T<Float> geometric = geometric_normal(f, direction, seen);
  if (!any(f.smooth)) return geometric;
  return interpolated_normal(normal_sum_at(f, p.u, p.v), geometric);
}

// The same of any length, which its packing asks for no more.
[[gnu::always_inline]] inline Vec3T<Float> direction_at(const Facet<Float, Mask>& f, const VisiblePoint& p,
                                                        const Vec3T<Float>& direction, Mask seen) {
  const Vec3T<Float> geometric = geometric_normal(f, direction, seen);
  if (!any(f.smooth)) return geometric;
  return interpolated_direction(normal_sum_at(f, p.u, p.v), geometric);
}

void write_block(const SeenBlock& block, FullBlock& out) {
  const SurfaceView& scene = block.scene;
  const Vec3T<Float> zero = broadcast(Vec3{0, 0, 0});
  const auto nothing = [&](int g) VITRAL_INLINED {
    store(out.depth + g, Float(0.0f));
    store3(out.px, out.py, out.pz, g, zero);
    store3(out.nx, out.ny, out.nz, g, zero);
    store(out.albedo + g, Uint(0u));
    store(out.material + g, Uint(kNoMaterial));
    store(out.triangle + g, Uint(kNoTriangle));
  };
  for_each_visible(block, nothing,
                   [&](int g, Mask seen, const Facet<Float, Mask>& f, const VisiblePoint& p,
                       const Vec3T<Float>& direction, uint32_t number) VITRAL_INLINED {
                     store(out.depth + g, select(seen, p.t, Float(0.0f)));
                     store3(out.px, out.py, out.pz, g, select3(seen, position_at(f, p.u, p.v), zero));
                     store3(out.nx, out.ny, out.nz, g, select3(seen, normal_at(f, p, direction, seen), zero));
                     store(out.triangle + g, load(block.numbers + g));
                     if (number != kNoTriangle && bits(seen) == kAllLanes) {
                       const uint32_t material = scene.materials[number];
                       store(out.material + g, Uint(material));
                       store(out.albedo + g, Uint(scene.colors[material].rgba8));
                       return;
                     }
                     store(out.material + g, Uint(kNoMaterial));
                     store(out.albedo + g, Uint(0u));
                     for (uint32_t left = bits(seen); left != 0; left &= left - 1) {
                       const int lane = g + __builtin_ctz(left);
                       const uint32_t material = scene.materials[block.numbers[lane]];
                       out.material[lane] = material;
                       out.albedo[lane] = scene.colors[material].rgba8;
                     }
                   });
}

void write_block(const SeenBlock& block, MinBlock& out) {
  const SurfaceView& scene = block.scene;
  const auto nothing = [&](int g) VITRAL_INLINED {
    store(out.depth + g, Float(0.0f));
    store(out.normal + g, Uint(0u));
    for (int i = 0; i < kLanes; ++i) out.material[g + i] = kNoMinMaterial;
  };
  for_each_visible(
      block, nothing,
      [&](int g, Mask seen, const Facet<Float, Mask>& f, const VisiblePoint& p, const Vec3T<Float>& direction,
          uint32_t number) VITRAL_INLINED {
        store(out.depth + g, select(seen, p.t, Float(0.0f)));
        store(out.normal + g, select(seen, octahedral_normal(direction_at(f, p, direction, seen)), Uint(0u)));
        if (number != kNoTriangle && bits(seen) == kAllLanes) {
          const uint16_t material = static_cast<uint16_t>(scene.materials[number]);
          for (int i = 0; i < kLanes; ++i) out.material[g + i] = material;
          return;
        }
        for (int i = 0; i < kLanes; ++i) {
          const uint32_t triangle = block.numbers[g + i];
          out.material[g + i] =
              triangle == kNoTriangle ? kNoMinMaterial : static_cast<uint16_t>(scene.materials[triangle]);
        }
      });
}

// Calls body(number, block) for the blocks of the tile at (x, y) that are wanted, bit by bit.
template <class Body>
inline void for_each_block(const SurfaceView& scene, const Pinhole& camera, int x, int y,
                           const TileVisibility& tile, uint32_t wanted, const Body& body) {
  for (; wanted != 0; wanted &= wanted - 1) {
    const int i = __builtin_ctz(wanted);
    body(i, SeenBlock{scene, camera, x + i % kTileBlocksAcross * kBlockSide,
                      y + i / kTileBlocksAcross * kBlockSide, tile.triangle + i * kPacketSize});
  }
}

}  // namespace

// Put together in cache, then streamed: the frame's 40 bytes a pixel are more than caches hold, and writing
// them the ordinary way would read them first.
void write_full(const SurfaceView& scene, const Pinhole& camera, int x, int y, const TileVisibility& tile,
                uint32_t wanted, FullBlock* out) {
  FullBlock whole;
  for_each_block(scene, camera, x, y, tile, wanted, [&](int i, const SeenBlock& block) {
    write_block(block, whole);
    stream(out + i, &whole, sizeof whole);
  });
  finish_streams();
}

void write_min(const SurfaceView& scene, const Pinhole& camera, int x, int y, const TileVisibility& tile,
               uint32_t wanted, MinBlock* out) {
  for_each_block(scene, camera, x, y, tile, wanted,
                 [&](int i, const SeenBlock& block) { write_block(block, out[i]); });
}

void pack_full(const SurfacePacket& surfaces, const FlatColor* colors, FullBlock& out) {
  const PointPacket& p = surfaces.points;
  const Vec3T<Float> zero = broadcast(Vec3{0, 0, 0});
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask live = mask_of_bits(p.live >> g);
    store(out.depth + g, select(live, load(surfaces.t + g), Float(0.0f)));
    store3(out.px, out.py, out.pz, g, select3(live, load3(p.px, p.py, p.pz, g), zero));
    store3(out.nx, out.ny, out.nz, g, select3(live, load3(p.nx, p.ny, p.nz, g), zero));
    store(out.material + g, select(live, load(surfaces.material + g), Uint(kNoMaterial)));
    store(out.triangle + g, select(live, load(surfaces.triangle + g), Uint(kNoTriangle)));
  }
  for (int lane = 0; lane < kPacketSize; ++lane)
    out.albedo[lane] = p.live >> lane & 1 ? colors[surfaces.material[lane]].rgba8 : 0;
}

void pack_min(const SurfacePacket& surfaces, MinBlock& out) {
  const PointPacket& p = surfaces.points;
  for (int g = 0; g < kPacketSize; g += kLanes) {
    const Mask live = mask_of_bits(p.live >> g);
    store(out.depth + g, select(live, load(surfaces.t + g), Float(0.0f)));
    store(out.normal + g, select(live, octahedral_normal(load3(p.nx, p.ny, p.nz, g)), Uint(0u)));
  }
  for (int lane = 0; lane < kPacketSize; ++lane) {
    out.material[lane] = p.live >> lane & 1 ? static_cast<uint16_t>(surfaces.material[lane]) : kNoMinMaterial;
  }
}

}  // namespace VITRAL_ISA
}  // namespace vitral
