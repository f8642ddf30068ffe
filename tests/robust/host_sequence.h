// A random sequence of the calls that a host may make, half of them with a value that makes no sense: each is right or
// refused, and of an abandoned context all are refused.
#pragma once

#include "tests/robust/host_frame_calls.h"
#include "tests/robust/host_settings.h"

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

private:
    void clear() {
        wrong_ = false;
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
        expect(without_value(made), "add_mesh");
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
        expect(status, "remove_mesh");
    }
    void add_material() {
        const auto made = context_.add_material(material());
        if (made)
            materials_ = made.value() + 1;
        expect(without_value(made), "add_material");
    }
    void set_material() {
        if (materials_ == 0)
            return;
        const host::MaterialData data = material();
        expect(context_.set_material(pick(materials_), data), "set_material");
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
        expect(without_value(made), "add_instance", why);
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
        expect(context_.set_transform(instance, matrix()), "set_transform");
    }
    void set_surface() {
        const std::uint32_t instance = one_of(instances_);
        host::Vector3 albedo = {real(0, 1), 0.5f, 0.5f}, emission = {0, 0, real(0, 2)};
        if (wrong_)
            spoil(chance() ? std::span<float>(albedo) : std::span<float>(emission));
        expect(context_.set_surface(instance, albedo, emission), "set_surface");
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
        expect(status, "remove_instance");
    }
    void add_light() {
        if (lights_.size() > 8)
            return;
        const auto made = context_.add_light(light());
        if (made) {
            lights_.resize(made.value() + 1, false);
            lights_[made.value()] = true;
        }
        expect(without_value(made), "add_light");
    }
    void set_light() {
        const std::uint32_t number = one_of(lights_);
        expect(context_.set_light(number, light()), "set_light");
    }
    void remove_light() {
        std::uint32_t number = one_of(lights_);
        if (wrong_)
            number = std::uint32_t(lights_.size()) + pick(50);
        const Status status = context_.remove_light(number);
        if (status)
            lights_[number] = false;
        expect(status, "remove_light");
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
        for (const float colour : value.irradiance)
            EXPECT_TRUE(colour >= 0.0f && std::isfinite(colour)) << colour;
    }
    void set() {
        struct Choice {
            std::string_view name;
            const char* value;
        };
        constexpr Choice bad[] = {{"lights", "-1"}, {"lights", "nan"}, {"lights", ""},          {"", "1"},
                                  {"nothing", "1"}, {"lights", "1e9"}, {"baked_light", "maybe"}};
        const SettingValues& setting = host_settings[pick(std::size(host_settings))];
        const Choice choice =
            wrong_ ? bad[pick(std::size(bad))] : Choice{setting.name, setting.values[pick(setting.values.size())]};
        expect(context_.set(choice.name, choice.value), "set");
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
        static_cast<void>(context_.surface_id(pick(100)));
        static_cast<void>(host::view_projection({{bad_number(), 0, 0}}, pick(3), 7));
        expect(context_.statistics().counters.empty() ? Status(Error{"no counters", ErrorCode::device_lost}) : Status(),
               "statistics");
    }

    std::uint32_t materials_ = 0, live_ = 0;
    std::vector<bool> meshes_, instances_, lights_, sensors_; // by number: whether it is there
    std::vector<std::uint32_t> mesh_of_;                      // by instance
};

} // namespace sunfleck::tests
