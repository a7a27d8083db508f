/* SPDX-License-Identifier: BSD-3-Clause */
// Copies a file with the OpenEXR library that the loader is built with, older than the one in Python:
//
//     make_exr SOURCE TARGET N       the same texels and attributes with compression N (0 NONE, 1 RLE .. 4 PIZ)
#include <cstdlib>
#include <list>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    Imf::InputFile source(argv[1]);
    Imf::Header header = source.header();
    const int width = header.dataWindow().max.x + 1, height = header.dataWindow().max.y + 1;
    std::list<std::vector<float>> planes;
    Imf::FrameBuffer buffer;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
        planes.emplace_back(static_cast<size_t>(width) * height);
        char *base = reinterpret_cast<char *>(planes.back().data());
        buffer.insert(channel.name(), Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * width));
    }
    source.setFrameBuffer(buffer);
    source.readPixels(0, height - 1);
    header.compression() = static_cast<Imf::Compression>(std::atoi(argv[3]));
    Imf::OutputFile target(argv[2], header);
    target.setFrameBuffer(buffer);
    target.writePixels(height);
}
