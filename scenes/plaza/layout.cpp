// Where everything stands. North is +z, east is +x; the sun comes from the south-west.
#include "layout.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "parts.h"
#include "random.h"

namespace plaza {
namespace {

// A row of houses, side by side, from the left end of a wall frame.
void row(Mesh& mesh, const Frame& start, const std::vector<Building>& houses) {
  double x = 0;
  for (const Building& house : houses) {
    building(mesh, moved(start, {x, 0, 0}), house);
    x += house.bays * house.bay;
  }
}

// Frames of the walls: x runs to the right of one who looks at the wall from the square.
Frame wall_frame(const Vec3d& origin, double degrees) {
  return turned(Frame{origin, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, degrees);
}

Building house(int bays, double bay, Surface wall, Surface joinery, Ground ground_floor, int storeys,
               double height, uint32_t seed) {
  Building b;
  b.bays = bays;
  b.bay = bay;
  b.wall = wall;
  b.joinery = joinery;
  b.ground = ground_floor;
  b.storeys = storeys;
  b.height = height;
  b.seed = seed;
  return b;
}

Building plain(Building b) {
  b.finish = Finish::plain;
  return b;
}

void houses(Mesh& mesh, const Plan& plan) {
  begin_group(mesh, "north");
  Building palace = house(11, 3.6, Surface::plaster_ochre, Surface::paint_white, Ground::arcade, 3, 1.05, 71);
  palace.crown = Crown::balustrade;
  palace.depth = 12;
  // The north row looks south: its left end is in the east.
  row(mesh, wall_frame({plan.east - 9, plan.curb, plan.north}, 180),
      {house(3, 3.2, Surface::plaster_rose, Surface::paint_green, Ground::shops, 4, 1.0, 72), palace,
       house(4, 3.3, Surface::plaster_green, Surface::paint_white, Ground::shops, 4, 1.02, 73)});

  begin_group(mesh, "east");
  // The east row looks west: its left end is in the south. It runs on into the street at the corner.
  row(mesh, wall_frame({plan.east, plan.curb, plan.south}, -90),
      {house(5, 3.2, Surface::plaster_white, Surface::paint_green, Ground::shops, 4, 1.0, 81),
       house(4, 3.3, Surface::plaster_rose, Surface::paint_white, Ground::shops, 4, 1.04, 82),
       house(5, 3.1, Surface::azulejo, Surface::paint_white, Ground::shops, 4, 0.98, 83),
       house(4, 3.4, Surface::plaster_white, Surface::paint_green, Ground::cafe, 4, 1.05, 84),
       house(4, 3.2, Surface::plaster_blue, Surface::paint_white, Ground::doors, 3, 1.08, 85),
       house(4, 3.3, Surface::plaster_ochre, Surface::paint_green, Ground::shops, 4, 1.0, 86),
       house(5, 3.2, Surface::plaster_rose, Surface::paint_white, Ground::doors, 4, 1.06, 87)});

  begin_group(mesh, "street");
  // Behind the north row: houses of the next street and the one that closes the view.
  row(mesh, wall_frame({plan.east + 4, 0, plan.north + 52}, 180),
      {plain(house(5, 3.3, Surface::plaster_white, Surface::paint_white, Ground::doors, 4, 1.1, 88)),
       plain(house(5, 3.2, Surface::plaster_ochre, Surface::paint_white, Ground::doors, 4, 1.25, 89)),
       plain(house(6, 3.2, Surface::plaster_blue, Surface::paint_white, Ground::doors, 4, 1.05, 90)),
       plain(house(6, 3.3, Surface::plaster_rose, Surface::paint_white, Ground::doors, 4, 1.2, 91))});

  begin_group(mesh, "west");
  row(mesh, wall_frame({plan.west, plan.curb, plan.north - 2}, 90),
      {plain(house(5, 3.3, Surface::plaster_white, Surface::paint_green, Ground::shops, 4, 0.95, 92)),
       plain(house(5, 3.3, Surface::plaster_ochre, Surface::paint_white, Ground::shops, 3, 1.0, 93)),
       plain(house(5, 3.2, Surface::plaster_rose, Surface::paint_white, Ground::shops, 4, 0.92, 94)),
       plain(house(5, 3.2, Surface::plaster_green, Surface::paint_white, Ground::shops, 3, 1.0, 95))});

  // The south side is open: two low galleries with terraces, and houses beyond a street.
  begin_group(mesh, "south");
  const double bay = 3.6;
  for (const auto& [west_end, bays] : {std::pair{plan.west + 8, 4}, std::pair{28.0, 5}}) {
    const Frame gallery = wall_frame({west_end, plan.curb, plan.south}, 0);
    const double top = arcade(mesh, gallery, bays, bay, Finish::plain);
    // The shops behind the gallery lie under the same terrace.
    box(mesh, Surface::plaster_white, gallery, {0.01, -0.1, -6.8}, {bays * bay - 0.01, top - 0.03, -4.21},
        kLeft | kRight | kBack);
    box(mesh, Surface::stone, gallery, {-0.1, top - 0.02, -6.9}, {bays * bay + 0.1, top + 0.2, 0.25});
    balustrade(mesh, moved(gallery, {0, top + 0.2, 0}), 0, bays * bay);
  }
  row(mesh, wall_frame({plan.west - 8, 0, plan.south - 20}, 0),
      {plain(house(6, 3.3, Surface::plaster_rose, Surface::paint_white, Ground::doors, 4, 0.95, 96)),
       plain(house(6, 3.2, Surface::plaster_white, Surface::paint_white, Ground::doors, 3, 1.0, 97)),
       plain(house(7, 3.3, Surface::azulejo, Surface::paint_white, Ground::doors, 4, 0.9, 98)),
       plain(house(6, 3.2, Surface::plaster_ochre, Surface::paint_white, Ground::doors, 3, 1.05, 99))});
}

void greenery(Mesh& mesh, const Plan& plan) {
  begin_group(mesh, "trees");
  const double y = plan.curb;
  uint32_t planted = 0;
  const auto plant = [&](double x, double z, Species species, double height) {
    tree(mesh, Frame{{x, y, z}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, species, height, hash(planted++, 17));
  };
  // An avenue along the east and the north of the island, and a few on the west.
  for (int i = 0; i < 5; ++i) {
    plant(34.6, -17.5 + 9.2 * i, i == 2 ? Species::jacaranda : Species::plane, 7.4 + 0.5 * (i % 3));
  }
  for (int i = 0; i < 5; ++i) {
    plant(26.5 - 9.2 * i, 20.6, i == 1 ? Species::jacaranda : Species::plane, 7.0 + 0.4 * ((i + 1) % 3));
  }
  plant(-9.5, 10, Species::plane, 8.4);
  plant(-9.5, 0, Species::jacaranda, 8);
  plant(-9.5, -10, Species::plane, 8.6);
  plant(2.6, -15.6, Species::plane, 7.6);
}

void furniture(Mesh& mesh, const Plan& plan) {
  const int lamps = is_bare(mesh.detail) ? 2 : 4;
  const auto at = [&](double x, double z, double degrees) {
    return turned(Frame{{x, plan.curb, z}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, degrees);
  };
  begin_group(mesh, "lamps");
  for (int i = 0; i < lamps; ++i) street_lamp(mesh, at(34.6, -12.9 + 9.2 * i, 90));
  for (int i = 0; i < lamps; ++i) street_lamp(mesh, at(21.9 - 9.2 * i, 20.6, 0));
  for (const double x : {4.5, 19.5}) street_lamp(mesh, at(x, -10.5, 0));
  for (const double x : {4.5, 19.5}) street_lamp(mesh, at(x, 10.5, 0));
  street_lamp(mesh, at(-9.5, -5, 90));
  street_lamp(mesh, at(-9.5, 5, 90));
  kiosk(mesh, at(26.5, 5.0, 10));
  if (is_bare(mesh.detail)) return;
  begin_group(mesh, "benches");
  for (int i = 0; i < 4; ++i) {
    bench(mesh, at(32.9, -12.9 + 9.2 * i, -90));
    bench(mesh, at(21.9 - 9.2 * i, 18.9, 180));
  }
  bench(mesh, at(-8, -5, 90));
  bench(mesh, at(-8, 5, 90));
  begin_group(mesh, "bollards");
  const double inset = plan.sidewalk - 0.75;
  for (int i = 0; i < 22; ++i) bollard(mesh, at(plan.east - inset, plan.south + 9 + 2.4 * i, 0));
  for (int i = 0; i < 24; ++i) bollard(mesh, at(plan.east - 12 - 2.4 * i, plan.north - inset, 0));
  for (int i = 0; i < 19; ++i)
    bollard(mesh, at(-11 + 2.4 * i, plan.south + plan.sidewalk + plan.road + 0.7, 0));
  begin_group(mesh, "cafe");
  for (uint32_t i = 0; i < 5; ++i)
    cafe_table(mesh, at(28.2 + 2.9 * (i % 2) + 0.5 * (i / 2), 9.5 + 2.9 * (i / 2), 31.0 * i), i);
  flower_stall(mesh, at(9.4, -17.6, 205));
}

void life(Mesh& mesh, const Plan& plan) {
  begin_group(mesh, "people");
  Random random{2024, 0};
  const Surface cloths[] = {Surface::cloth_blue,  Surface::cloth_red, Surface::cloth_grey,
                            Surface::paint_white, Surface::canvas,    Surface::hair};
  const auto person = [&](double x, double z, double heading) {
    Figure walker;
    walker.height = between(random, 1.58, 1.86);
    walker.cloth = cloths[hash(static_cast<uint32_t>(random.count), 5) % 6];
    walker.skin = Surface::skin;
    walker.hair = Surface::hair;
    walker.dress = uniform(random) < 0.35 ? Figure::Dress::robe : Figure::Dress::trousers;
    walker.stride = between(random, 4, 24);
    walker.left_arm = between(random, 6, 14);
    walker.right_arm = between(random, 6, 14);
    walker.left_fore = between(random, 5, 60);
    walker.right_fore = between(random, 5, 40);
    figure(mesh, turned(Frame{{x, plan.curb, z}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, heading), walker);
  };
  const double places[][3] = {
      {18.5, -14.2, 120}, {19.2, -13.6, 130}, {27.5, -4.5, 20},  {8.2, -15.4, 60},  {9.1, -15.9, 165},
      {14.5, -18.5, -30}, {4.0, -7.5, 80},    {22.5, 3.5, -100}, {21.8, 4.1, 100},  {30.8, 1.0, 0},
      {33.0, -19.0, 10},  {16.5, 13.5, 170},  {7.0, 15.0, 90},   {1.5, 13.0, 40},   {-4.5, 2.0, 20},
      {46.2, 6.0, 5},     {45.9, 17.5, 185},  {45.8, -2.5, 175}, {30.0, 31.2, 90},  {18.0, 31.6, -90},
      {17.2, 31.2, -88},  {5.0, 31.0, 90},    {-3.0, 31.5, 85},  {36.5, 30.8, -70}, {29.5, 8.0, 200},
      {24.0, 8.2, 130},   {31.5, -7.5, -20},  {12.3, -7.3, 180}, {18.8, -1.5, 260}, {0.5, -9.5, 15}};
  int rank = 0;
  for (const auto& p : places) {
    if (!is_coarse(mesh.detail) || rank++ % 3 == 0) person(p[0], p[1], p[2]);
  }
  // Pigeons: a body, a head, a tail.
  begin_group(mesh, "pigeons");
  for (int i = 0; i < std::min(many(mesh.detail, 40), 120); ++i) {
    const double x = 15.2 + between(random, -3.6, 3.6), z = -12.5 + between(random, -3.2, 3.2);
    const Frame bird =
        turned(Frame{{x, plan.curb, z}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, between(random, 0, 360));
    const Surface plumage = i % 5 == 0 ? Surface::paint_white : Surface::cloth_grey;
    ellipsoid(mesh, plumage, moved(bird, {0, 0.13, 0}), {0.065, 0.07, 0.13}, divisions(mesh.detail, 7, 4));
    ellipsoid(mesh, plumage, moved(bird, {0, 0.23, 0.11}), {0.03, 0.045, 0.04}, divisions(mesh.detail, 6, 4));
    box(mesh, plumage, bird, {-0.035, 0.11, -0.24}, {0.035, 0.13, -0.1});
  }
}

}  // namespace

void lay_out(Mesh& mesh) {
  const Plan plan;
  const auto at = [&](double x, double y, double z) {
    return Frame{{x, y, z}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  };
  ground(mesh, plan);
  houses(mesh, plan);
  skyline(mesh, plan);
  // The poet looks at the sun.
  monument(mesh, turned(at(plan.monument.x, plan.curb, plan.monument.z), 200));
  fountain(mesh, at(plan.monument.x + 13, plan.curb, plan.monument.z - 13));
  fountain(mesh, at(plan.monument.x - 13, plan.curb, plan.monument.z + 13));
  greenery(mesh, plan);
  furniture(mesh, plan);
  if (!is_bare(mesh.detail)) life(mesh, plan);
  tram(mesh, turned(at(23.2, 0, plan.south + plan.sidewalk + 3.7), 180));
  if (!is_bare(mesh.detail)) tram(mesh, turned(at(27, 0, plan.north - plan.sidewalk - plan.road + 1.5), 0));
}

}  // namespace plaza
