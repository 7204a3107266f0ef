# The command in a small image: docker build -t twinslip .
# Files go through the folder of work: docker run --rm -v "$PWD:/data" twinslip run relaxation -o run.csv
FROM rust:1-bookworm AS build
WORKDIR /src
COPY . .
RUN apt-get update -qq && packaging/build deb

FROM debian:bookworm-slim
COPY --from=build /src/target/packages/twinslip_*.deb /tmp/twinslip.deb
RUN dpkg --install /tmp/twinslip.deb \
    && rm /tmp/twinslip.deb \
    && useradd --create-home --uid 1000 twinslip \
    && install --directory --owner=twinslip /data
# By its number, which hosts that refuse images of root can check.
USER 1000
WORKDIR /data
ENTRYPOINT ["twinslip"]
CMD ["--help"]
