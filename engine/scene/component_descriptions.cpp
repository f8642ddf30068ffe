// The one description of each component's fields.
#include "engine/scene/components.h"
#include "engine/scene/environment_map.h"
#include "engine/scene/simulation_components.h"

namespace sunfleck::scene {

const TypeDescription& Name::description() {
    static const TypeDescription type{
        "Name", 1, "A label; node name in glTF.", {SUNFLECK_FIELD(Name, name, "", 0, 0, "Label shown in lists")}};
    return type;
}

const TypeDescription& Transform::description() {
    static const TypeDescription type{"Transform",
                                      1,
                                      "Position, rotation and scale relative to the parent.",
                                      {SUNFLECK_FIELD(Transform, position, "m", -1e5, 1e5, "Translation"),
                                       SUNFLECK_FIELD(Transform, rotation, "", -1, 1, "Unit quaternion x,y,z,w"),
                                       SUNFLECK_FIELD(Transform, scale, "", -1e4, 1e4, "Scale along the local axes")}};
    return type;
}

const TypeDescription& Parent::description() {
    static const TypeDescription type{"Parent",
                                      1,
                                      "The entity whose transform this one is relative to.",
                                      {SUNFLECK_FIELD(Parent, parent, "", 0, 0, "Parent entity")}};
    return type;
}

const TypeDescription& MeshInstance::description() {
    static const TypeDescription type{
        "MeshInstance",
        1,
        "Geometry.",
        {SUNFLECK_FIELD(MeshInstance, mesh, "", 0, 4294967295.0, "Index in the mesh store")}};
    return type;
}

const TypeDescription& Material::description() {
    static const TypeDescription type{
        "Material",
        1,
        "BSDF of the mesh.",
        {SUNFLECK_FIELD(Material, base_colour, "", 0, 1, "Diffuse albedo, or reflectance of a metal"),
         SUNFLECK_FIELD(Material, metallic, "", 0, 1, "0 dielectric, 1 metal"),
         SUNFLECK_FIELD(Material, roughness, "", 0, 1, "Perceptual roughness; GGX alpha is its square"),
         SUNFLECK_FIELD(Material, emission, "W/(sr m2)", 0, 1e9, "Radiance emitted on the front side"),
         SUNFLECK_FIELD(Material, transmission, "", 0, 1, "Above 0: smooth glass"),
         SUNFLECK_FIELD(Material, index_of_refraction, "", 1, 4, "Of glass and of the dielectric layer"),
         SUNFLECK_FIELD(Material, specular, "", 0, 1, "Adds a dielectric GGX layer"),
         SUNFLECK_CHOICE(Material, alpha_mode, "How alpha is used: ignored, as a cut-out mask, or as opacity", "opaque",
                         "mask", "blend"),
         SUNFLECK_FIELD(Material, alpha, "", 0, 1,
                        "Fraction of light that the surface blocks, times its texture's alpha"),
         SUNFLECK_FIELD(Material, alpha_cutoff, "", 0, 1, "A masked surface is cut out where alpha is below this"),
         SUNFLECK_FIELD(Material, double_sided, "", 0, 1, "Also visible from behind"),
         SUNFLECK_FIELD(Material, unlit, "", 0, 1, "Shows its base colour, unaffected by light")}};
    return type;
}

const TypeDescription& Camera::description() {
    static const TypeDescription type{
        "Camera",
        1,
        "Perspective camera, looking along its -Z axis.",
        {SUNFLECK_FIELD(Camera, vertical_field_of_view, "rad", 0.01, 3.1, "Angle from bottom to top")}};
    return type;
}

const TypeDescription& Exposure::description() {
    static const TypeDescription type{
        "Exposure",
        1,
        "Exposure of the image.",
        {SUNFLECK_FIELD(Exposure, ev100, "EV", -16, 32,
                        "Exposure value at ISO 100; one stop more halves the brightness")}};
    return type;
}

const TypeDescription& AreaLight::description() {
    static const TypeDescription type{
        "AreaLight",
        1,
        "A diffuse area light of simple shape.",
        {SUNFLECK_CHOICE(AreaLight, shape, "Shape of the emitter", "rectangle", "disc", "sphere"),
         SUNFLECK_FIELD(AreaLight, width, "m", 0, 1e4, "Width of a rectangle, along X"),
         SUNFLECK_FIELD(AreaLight, height, "m", 0, 1e4, "Height of a rectangle, along Y"),
         SUNFLECK_FIELD(AreaLight, radius, "m", 0, 1e4, "Radius of a disc or sphere"),
         SUNFLECK_FIELD(AreaLight, radiance, "W/(sr m2)", 0, 1e9, "Emitted radiance")}};
    return type;
}

const TypeDescription& PointLight::description() {
    static const TypeDescription type{"PointLight",
                                      1,
                                      "A point light: radiates equally in all directions.",
                                      {SUNFLECK_FIELD(PointLight, intensity, "W/sr", 0, 1e9, "Radiant intensity")}};
    return type;
}

const TypeDescription& SpotLight::description() {
    static const TypeDescription type{
        "SpotLight",
        1,
        "A spot light: radiates in a cone about its -Z axis.",
        {SUNFLECK_FIELD(SpotLight, intensity, "W/sr", 0, 1e9, "Radiant intensity on the axis"),
         SUNFLECK_FIELD(SpotLight, inner_angle, "rad", 0, 1.5707963, "Half angle of the cone of full intensity"),
         SUNFLECK_FIELD(SpotLight, outer_angle, "rad", 0, 1.5707963,
                        "Half angle at which the light has fallen to zero")}};
    return type;
}

const TypeDescription& DirectionalLight::description() {
    static const TypeDescription type{
        "DirectionalLight",
        1,
        "Parallel light along its -Z axis.",
        {SUNFLECK_FIELD(DirectionalLight, irradiance, "W/m2", 0, 1e9, "Irradiance on a plane that faces the light")}};
    return type;
}

const TypeDescription& Environment::description() {
    static const TypeDescription type{
        "Environment",
        1,
        "Light from the surroundings, for rays that hit nothing.",
        {SUNFLECK_FIELD(Environment, radiance, "W/(sr m2)", 0, 1e9, "Uniform radiance of the surroundings"),
         SUNFLECK_FIELD(Environment, lights, "", 0, 1, "Off: a visible background that lights nothing")}};
    return type;
}

const TypeDescription& EnvironmentMap::description() {
    static const TypeDescription type{
        "EnvironmentMap",
        1,
        "Environment map that scales the Environment's radiance by direction.",
        {SUNFLECK_FIELD(
             EnvironmentMap, file, "", 0, 0,
             "Equirectangular PNG, JPEG, EXR or HDR, relative to the scene file; or summer_sky, which is made by code"),
         SUNFLECK_FIELD(EnvironmentMap, rotation, "rad", -7, 7, "Rotation about the vertical")}};
    return type;
}

const TypeDescription& Mover::description() {
    static const TypeDescription type{
        "Mover",
        1,
        "Moves along a path, as a function of the simulation step.",
        {SUNFLECK_CHOICE(Mover, path, "Kind of path", "none", "line", "circle", "spin", "hinge", "spline"),
         SUNFLECK_FIELD(Mover, travel, "m", -1e4, 1e4,
                        "Line: half of the travel, from the start; if activated: all of it"),
         SUNFLECK_FIELD(Mover, centre, "m", -1e4, 1e4, "Circle: its centre; hinge: a point on its axis"),
         SUNFLECK_FIELD(Mover, axis, "", -1, 1, "Circle, spin and hinge: axis of rotation"),
         SUNFLECK_FIELD(Mover, angle, "rad", -6.3, 6.3, "Hinge: angle of rotation"),
         SUNFLECK_FIELD(Mover, period, "s", 0.01, 1e4, "Time of one full cycle"),
         SUNFLECK_FIELD(Mover, phase, "", -1, 1, "Initial phase, as a fraction of the period"),
         SUNFLECK_FIELD(Mover, spin_period, "s", 0, 1e4,
                        "Time of one revolution about its own vertical axis; 0: no spin"),
         SUNFLECK_CHOICE(Mover, easing, "Line and hinge: easing of the motion", "sine", "linear", "dwell"),
         SUNFLECK_CHOICE(
             Mover, activation,
             "Moves always, while a person is near, when used, or while light sensors that name it are open", "clock",
             "near", "use", "sensor"),
         SUNFLECK_FIELD(Mover, reach, "m", 0, 100, "Distance at which a person activates it")}};
    return type;
}

const TypeDescription& SurfacePattern::description() {
    static const TypeDescription type{
        "SurfacePattern",
        1,
        "A pattern on a surface.",
        {SUNFLECK_CHOICE(SurfacePattern, kind, "Kind of pattern", "none", "checker", "planks", "bricks", "marble"),
         SUNFLECK_FIELD(SurfacePattern, colour, "", 0, 1, "Second colour; the first is the material's base colour"),
         SUNFLECK_FIELD(SurfacePattern, scale, "m", 0.001, 1000, "Size of a square, plank, brick or vein")}};
    return type;
}

const TypeDescription& ShadowCasting::description() {
    static const TypeDescription type{
        "ShadowCasting",
        1,
        "Whether a moving mesh casts shadows.",
        {SUNFLECK_FIELD(ShadowCasting, casts, "", 0, 1, "Off for thin objects and lamp housings")}};
    return type;
}

void register_components(ecs::Registry& registry) {
    registry.register_component<Name>();
    registry.register_component<Transform>();
    registry.register_component<Parent>();
    registry.register_component<MeshInstance>();
    registry.register_component<Material>();
    registry.register_component<Camera>();
    registry.register_component<Exposure>();
    registry.register_component<AreaLight>();
    registry.register_component<PointLight>();
    registry.register_component<SpotLight>();
    registry.register_component<DirectionalLight>();
    registry.register_component<Environment>();
    registry.register_component<EnvironmentMap>();
    registry.register_component<Mover>();
    registry.register_component<SurfacePattern>();
    registry.register_component<ShadowCasting>();
    register_simulation_components(registry);
}

} // namespace sunfleck::scene
