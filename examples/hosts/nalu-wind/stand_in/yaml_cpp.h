// A stand-in for yaml-cpp, for tests: nodes of flow-style texts, { key: value, key: [a, b] }. As there, a value that is
// missing or of another type throws. Written anew: no line of theirs is here.
#ifndef YAML_CPP_STAND_IN_H
#define YAML_CPP_STAND_IN_H

#include <cctype>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace YAML {

class Node {
  public:
    using Pair = std::pair<Node, Node>;
    Node() = default;

    explicit operator bool() const {
        return m_kind != none;
    }
    bool IsMap() const {
        return m_kind == map;
    }
    bool IsSequence() const {
        return m_kind == sequence;
    }
    size_t size() const {
        return m_items.size();
    }
    Node operator[](const std::string &key) const {
        for (const auto &item : m_items) {
            if (m_kind == map && item.first.m_text == key) {
                return item.second;
            }
        }
        return {};
    }
    Node operator[](const char *key) const {
        return (*this)[std::string(key)];
    }
    Node operator[](size_t i) const {
        return i < m_items.size() ? m_items[i].second : Node();
    }
    std::vector<Pair>::const_iterator begin() const {
        return m_items.begin();
    }
    std::vector<Pair>::const_iterator end() const {
        return m_items.end();
    }
    template <typename T> T as() const {
        T value{};
        read(value);
        return value;
    }

  private:
    friend Node Load(const std::string &text);
    enum Kind { none, scalar, sequence, map };

    void read(std::string &value) const {
        need(m_kind == scalar);
        value = m_text;
    }
    void read(bool &value) const {
        need(m_kind == scalar && (m_text == "true" || m_text == "false"));
        value = m_text == "true";
    }
    template <typename T> void read(T &value) const {
        std::istringstream in(m_text);
        need(m_kind == scalar && (in >> value) && in.eof());
    }
    template <typename T> void read(std::vector<T> &values) const {
        need(m_kind == sequence);
        for (const auto &item : m_items) {
            values.push_back(item.second.as<T>());
        }
    }
    void need(bool good) const {
        if (!good) {
            throw std::runtime_error("yaml-cpp: bad conversion of '" + m_text + "'");
        }
    }

    static char next(std::istream &in) {
        in >> std::ws;
        return static_cast<char>(in.peek());
    }
    static Node parse(std::istream &in) {
        Node node;
        const char first = next(in), last = first == '{' ? '}' : ']';
        if (first != '{' && first != '[') {
            node.m_kind = scalar;
            while (in.good() && std::string(",:]}").find(static_cast<char>(in.peek())) == std::string::npos) {
                node.m_text += static_cast<char>(in.get());
            }
            while (!node.m_text.empty() && std::isspace(static_cast<unsigned char>(node.m_text.back())) != 0) {
                node.m_text.pop_back();
            }
            return node;
        }
        node.m_kind = first == '{' ? map : sequence;
        in.get();
        while (next(in) != last) {
            Node key;
            if (node.m_kind == map) {
                key = parse(in);
                in.get(); // the colon
            }
            node.m_items.emplace_back(key, parse(in));
            if (next(in) == ',') {
                in.get();
            }
        }
        in.get();
        return node;
    }

    Kind m_kind{none};
    std::string m_text;
    std::vector<Pair> m_items;
};

inline Node Load(const std::string &text) {
    std::istringstream in(text);
    return Node::parse(in);
}

} // namespace YAML

#endif
