// A random sequence of the calls that a host may make, half of them with a value that makes no sense: each is right or
// refused, and of an abandoned context all are refused.
#pragma once

#include "tests/robust/host_frame_calls.h"
#include "tests/robust/host_settings.h"

#include <functional>
#include <optional>

namespace sunfleck::tests {

using host::Mobility;

// Calls a host might make, half of them with a value that makes no sense.
class Sequence : public FrameCalls {
public:
    // `hook`: what the context's log calls.
    Sequence(std::uint32_t seed, HostProgram& program, host::Context& context, LogHook& hook)
        : FrameCalls(seed, program, context, hook) {}

    void call() {
        static constexpr void (Sequence::*calls[])() = {
            &Sequence::add_mesh,     &Sequence::remove_mesh,   &Sequence::add_material,  &Sequence::set_material,
            &Sequence::add_instance, &Sequence::set_transform, &Sequence::set_surface,   &Sequence::remove_instance,
            &Sequence::add_light,    &Sequence::set_light,     &Sequence::remove_light,  &Sequence::set,
            &Sequence::add_sensor,   &Sequence::set_sensor,    &Sequence::remove_sensor, &Sequence::step_sensors,
            &Sequence::look,         &Sequence::create,        &Sequence::frame,         &Sequence::frame,
            &Sequence::frame,        &Sequence::add_speck};
        // Half of the calls are of values that make no sense, whichever they are.
        wrong_ = pick(2) == 0;
        if (pick(100) == 0)
            clear();
        else
            (this->*calls[pick(std::size(calls))])();
    }
    // From here on every call that can fail does.
    void abandon() {
        context_.abandon();
        abandoned_ = true;
        ++tally.calls["abandon"];
        log += " abandon";
    }
    // The scene as the calls that succeeded describe it, told to a context that has none.
    Status describe_again(host::Context& other) const {
        for (const std::function<Status(host::Context&)>& call : accepted_)
            SUNFLECK_TRY(call(other));
        return {};
    }

    std::optional<std::uint32_t> an_instance() const {
        const auto found = std::find(instances_.begin(), instances_.end(), true);
        return found == instances_.end() ? std::nullopt : std::optional(std::uint32_t(found - instances_.begin()));
    }

private:
    // Calls that change the scene, for describe_again.
    void expect_change(const Status& status, const char* call, std::function<Status(host::Context&)> again,
                       const std::string& why = "") {
        if (status)
            accepted_.push_back(std::move(again));
        expect(status, call, why);
    }
    // The same of one that adds something, which has the same number again.
    template <typename Add>
    void expect_added(const Result<std::uint32_t>& made, const char* call, Add add, const std::string& why = "") {
        const std::uint32_t wanted = made ? made.value() : 0;
        const auto again = [add = std::move(add), wanted, call](host::Context& other) -> Status {
            SUNFLECK_ASSIGN(const std::uint32_t number, add(other));
            return number == wanted ? Status() : Status(Error{std::string(call) + " gives another number"});
        };
        expect_change(without_value(made), call, again, why);
    }
    void clear() {
        wrong_ = false;
        accepted_.clear();
        expect(context_.clear(), "clear");
        meshes_.clear(), instances_.clear(), lights_.clear(), sensors_.clear(), mesh_of_.clear();
        materials_ = live_ = 0;
    }
    // A context more would cost half of a sequence's time: good ones are made beside the sequences.
    void create() {
        wrong_ = true;
        host::VulkanHandles handles = program_.handles();
        switch (pick(4)) {
        case 0:
            handles.instance = VK_NULL_HANDLE;
            break;
        case 1:
            handles.physical_device = VK_NULL_HANDLE;
            break;
        case 2:
            handles.device = VK_NULL_HANDLE;
            break;
        default:
            handles.queue = VK_NULL_HANDLE;
            break;
        }
        expect(without_value(host::Context::create(handles)), "create");
    }

    void add_mesh() {
        if (meshes_.size() >= 12)
            return;
        const Mesh mesh = this->mesh();
        const auto made = context_.add_mesh({mesh.positions, mesh.normals, mesh.indices, mesh.texture_coordinates});
        if (made) {
            meshes_.resize(made.value() + 1, false);
            meshes_[made.value()] = true;
        }
        expect_added(made, "add_mesh", [mesh](host::Context& other) {
            return other.add_mesh({mesh.positions, mesh.normals, mesh.indices, mesh.texture_coordinates});
        });
    }
    bool is_used(std::uint32_t mesh) const {
        for (std::uint32_t i = 0; i < instances_.size(); ++i)
            if (instances_[i] && mesh_of_[i] == mesh)
                return true;
        return false;
    }
    // Those that an instance has are refused, too.
    void remove_mesh() {
        std::uint32_t mesh = one_of(meshes_);
        if (wrong_)
            mesh = std::uint32_t(meshes_.size()) + pick(100);
        wrong_ = wrong_ || is_used(mesh);
        const Status status = context_.remove_mesh(mesh);
        if (status)
            meshes_[mesh] = false;
        expect_change(status, "remove_mesh", [mesh](host::Context& other) { return other.remove_mesh(mesh); });
    }
    void add_material() {
        const host::MaterialData data = material();
        const auto made = context_.add_material(data);
        if (made)
            materials_ = made.value() + 1;
        expect_added(made, "add_material", [data, pixels = pixels_](host::Context& other) {
            return other.add_material(with_pixels(data, pixels));
        });
    }
    void set_material() {
        if (materials_ == 0)
            return;
        const host::MaterialData data = material();
        const std::uint32_t number = pick(materials_);
        expect_change(context_.set_material(number, data), "set_material",
                      [number, data, pixels = pixels_](host::Context& other) {
                          return other.set_material(number, with_pixels(data, pixels));
                      });
    }
    // The material's texture refers to pixels_, which the next material has of its own.
    static host::MaterialData with_pixels(host::MaterialData data, const std::vector<std::uint8_t>& pixels) {
        if (!data.albedo_texture.pixels.empty())
            data.albedo_texture.pixels = pixels;
        return data;
    }
    void add_instance() {
        if (std::count(meshes_.begin(), meshes_.end(), true) == 0 || live_ >= 12)
            return;
        host::InstanceData data;
        const std::uint32_t mistake = wrong_ ? pick(5) : 9;
        const bool wrong = std::exchange(wrong_, mistake == 0);
        data.mesh = wrong_ ? std::uint32_t(meshes_.size()) + pick(1000) : one_of(meshes_);
        wrong_ = mistake == 1;
        data.transform = matrix();
        wrong_ = wrong;
        data.mobility = mistake == 2 ? Mobility(2 + pick(100)) : chance() ? Mobility::fixed : Mobility::moving;
        data.albedo = {real(0, 1), real(0, 1), mistake == 3 ? 5.0f : real(0, 1)};
        if (mistake == 4)
            data.material = materials_ + 5;
        else if (materials_ > 0 && chance())
            data.material = pick(materials_);
        add(data, "mistake " + std::to_string(mistake));
    }
    void add(const host::InstanceData& data, const std::string& why) {
        const auto made = context_.add_instance(data);
        if (made) {
            instances_.resize(made.value() + 1, false);
            instances_[made.value()] = true;
            mesh_of_.resize(made.value() + 1, 0);
            mesh_of_[made.value()] = data.mesh;
            ++live_;
        }
        expect_added(
            made, "add_instance", [data](host::Context& other) { return other.add_instance(data); }, why);
    }
    // An emitter without area, which is left out and said in the log.
    void add_speck() {
        if (std::count(meshes_.begin(), meshes_.end(), true) == 0 || live_ >= 12)
            return;
        wrong_ = false;
        host::InstanceData data{one_of(meshes_), box_matrix(vec3(0, 1, 0), vec3(1e-12f))};
        data.emission = {3, 3, 3};
        add(data, "a speck");
    }
    // An instance or light that is there; without one, a wrong one.
    std::uint32_t one_of(const std::vector<bool>& list) {
        const std::uint32_t start = pick(list.size() + 1);
        for (std::uint32_t i = 0; i < list.size(); ++i)
            if (const std::uint32_t k = (start + i) % std::uint32_t(list.size()); list[k])
                return k;
        wrong_ = true;
        return std::uint32_t(list.size()) + pick(9);
    }
    void set_transform() {
        const std::uint32_t instance = one_of(instances_);
        const host::Matrix4 to = matrix();
        expect_change(context_.set_transform(instance, to), "set_transform",
                      [instance, to](host::Context& other) { return other.set_transform(instance, to); });
    }
    void set_surface() {
        const std::uint32_t instance = one_of(instances_);
        host::Vector3 albedo = {real(0, 1), 0.5f, 0.5f}, emission = {0, 0, real(0, 2)};
        if (wrong_)
            spoil(chance() ? std::span<float>(albedo) : std::span<float>(emission));
        expect_change(context_.set_surface(instance, albedo, emission), "set_surface",
                      [instance, albedo, emission](host::Context& other) {
                          return other.set_surface(instance, albedo, emission);
                      });
    }
    void remove_instance() {
        std::uint32_t instance = one_of(instances_);
        if (wrong_)
            instance = std::uint32_t(instances_.size()) + pick(50);
        const Status status = context_.remove_instance(instance);
        if (status) {
            instances_[instance] = false;
            --live_;
        }
        expect_change(status, "remove_instance",
                      [instance](host::Context& other) { return other.remove_instance(instance); });
    }
    void add_light() {
        if (lights_.size() > 8)
            return;
        const host::LightData data = light();
        const auto made = context_.add_light(data);
        if (made) {
            lights_.resize(made.value() + 1, false);
            lights_[made.value()] = true;
        }
        expect_added(made, "add_light", [data](host::Context& other) { return other.add_light(data); });
    }
    void set_light() {
        const std::uint32_t number = one_of(lights_);
        const host::LightData data = light();
        expect_change(context_.set_light(number, data), "set_light",
                      [number, data](host::Context& other) { return other.set_light(number, data); });
    }
    void remove_light() {
        std::uint32_t number = one_of(lights_);
        if (wrong_)
            number = std::uint32_t(lights_.size()) + pick(50);
        const Status status = context_.remove_light(number);
        if (status)
            lights_[number] = false;
        expect_change(status, "remove_light", [number](host::Context& other) { return other.remove_light(number); });
    }
    host::SensorData sensor() {
        host::SensorData data;
        data.position = {real(-1.5f, 1.5f), real(0.2f, 2.3f), real(-1.5f, 1.5f)};
        data.normal = {real(-1, 1), 1, real(-1, 1)};
        if (wrong_)
            spoil(chance() ? data.position : chance() ? data.normal : data.threshold);
        return data;
    }
    void add_sensor() {
        if (sensors_.size() > 4)
            return;
        const auto made = context_.add_sensor(sensor());
        if (made) {
            sensors_.resize(made.value() + 1, false);
            sensors_[made.value()] = true;
        }
        expect(without_value(made), "add_sensor");
    }
    void set_sensor() {
        const std::uint32_t number = one_of(sensors_);
        expect(context_.set_sensor(number, sensor()), "set_sensor");
    }
    void remove_sensor() {
        std::uint32_t number = one_of(sensors_);
        if (wrong_)
            number = std::uint32_t(sensors_.size()) + pick(50);
        const Status status = context_.remove_sensor(number);
        if (status)
            sensors_[number] = false;
        expect(status, "remove_sensor");
    }
    void step_sensors() {
        wrong_ = false;
        expect(context_.step_sensors(), "step_sensors");
        const host::SensorValue value = context_.read_sensor(pick(9));
        ++tally.calls["read_sensor"];
        for (const float colour : value.irradiance)
            EXPECT_TRUE(colour >= 0.0f && std::isfinite(colour)) << colour;
    }
    void set() {
        const SettingValues& setting = host_settings[pick(std::size(host_settings))];
        if (!wrong_)
            return set(setting.name, setting.values[pick(setting.values.size())]);
        if (pick(8) == 0)
            return expect(context_.set(chance() ? "" : "nothing", "1"), "set", "no such setting");
        // Of no setting's kind.
        constexpr const char* bad[] = {"nan", "inf", "1e38", "-1", "maybe", "0x", "1 1"};
        const std::string value = bad[pick(std::size(bad))];
        expect(context_.set(setting.name, value), "set", std::string(setting.name) + " = " + value);
    }
    // A value of the setting's kind is accepted unless it contradicts another setting.
    void set(std::string_view name, std::string_view value) {
        const std::string_view movers = name == "movers" ? value : movers_, plan = name == "plan" ? value : plan_;
        wrong_ = contradict(movers, plan);
        const Status status = context_.set(name, value);
        if (status) {
            movers_ = movers;
            plan_ = plan;
        }
        expect(status, "set", "movers = " + std::string(movers) + ", plan = " + std::string(plan));
    }
    // What returns no status: any number will do.
    void look() {
        wrong_ = false;
        const host::VulkanHandles handles = program_.handles();
        if (!abandoned_) // it knows no context
            expect(without_value(host::missing_features(handles.instance, handles.physical_device)),
                   "missing_features");
        VkPhysicalDeviceFeatures2 features{};
        VkPhysicalDeviceVulkan13Features features13{};
        host::enable_features(chance() ? nullptr : &features.features, nullptr, chance() ? nullptr : &features13);
        const std::uint64_t free_of_limits = std::uint64_t(1) << 62;
        host::set_memory_limit(chance() ? 0 : free_of_limits); // of the whole process
        static_cast<void>(context_.surface_id(pick(100)));
        static_cast<void>(host::view_projection({{bad_number(), 0, 0}}, pick(3), 7));
        for (const char* name : {"enable_features", "set_memory_limit", "surface_id", "view_projection"})
            ++tally.calls[name];
        expect(context_.statistics().counters.empty() ? Status(Error{"no counters", ErrorCode::device_lost}) : Status(),
               "statistics");
    }

    std::vector<std::function<Status(host::Context&)>> accepted_;
    std::string_view movers_ = initial_value("movers"), plan_ = initial_value("plan");
    std::uint32_t materials_ = 0, live_ = 0;
    std::vector<bool> meshes_, instances_, lights_, sensors_; // by number: whether it is there
    std::vector<std::uint32_t> mesh_of_;                      // by instance
};

} // namespace sunfleck::tests
