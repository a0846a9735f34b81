//! `serve`: open the store, listen, stop gracefully.

use std::{io, net::SocketAddr, sync::Arc};

use serde_json::json;
use tokio::net::TcpListener;

use super::{CommandFailure, Context, Exit, descriptors::raise_descriptor_limit, failed, settings::ServeSettings};
use ltcforge_server::{http, service::Service};

/// Runs the service until it is interrupted.
pub(super) fn run(settings: &ServeSettings, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let (listen, config) = (settings.listen, settings.config());
    raise_descriptor_limit();
    let options = settings.http()?;
    let scheme = if options.certificate.is_some() { "https" } else { "http" };
    #[cfg(feature = "cluster")]
    let (config, shared) = (settings.replica.change(config), settings.replica.shared());
    let runtime = context.runtime.clone();
    runtime.block_on(async {
        let (listener, address) = self::listen(listen).await?;
        // An interrupt must not stop the process while it opens a data folder.
        #[cfg(feature = "cluster")]
        let opened = match shared {
            None => Some(tokio::task::spawn_blocking(move || Service::open(config)).await),
            Some(shared) => {
                let opening = tokio::task::spawn_blocking(move || Service::open_shared(config, &shared));
                super::replica::unless_interrupted(opening, context).await
            }
        };
        #[cfg(not(feature = "cluster"))]
        let opened = Some(tokio::task::spawn_blocking(move || Service::open(config)).await);
        let Some(opened) = opened else { return Ok(Exit::Ok) };
        let service = opened.map_err(failed)?.map_err(failed)?;
        let url = format!("{scheme}://{address}");
        context.print(&json!({ "listening": url }), &format!("listening on {url}"))?;
        let served = http::serve(listener, Arc::clone(&service), options, context.interrupt.clone().wait()).await;
        tokio::task::spawn_blocking(move || service.stop()).await.map_err(failed)?;
        served.map_err(failed)?;
        Ok(Exit::Ok)
    })
}

/// Binds a listener, and returns it with its actual address.
pub(super) async fn listen(listen: SocketAddr) -> Result<(TcpListener, SocketAddr), CommandFailure> {
    let bound = TcpListener::bind(listen).await.and_then(|listener| {
        let address = listener.local_addr()?;
        Ok((listener, address))
    });
    bound.map_err(|error| cannot_listen(listen, &error))
}

fn cannot_listen(listen: SocketAddr, error: &io::Error) -> CommandFailure {
    let reason = match error.kind() {
        io::ErrorKind::AddrInUse => "the port is already in use".to_owned(),
        _ => error.to_string(),
    };
    failed(format!("cannot listen on {listen}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_taken_port_is_named() {
        let refused = cannot_listen(ServeSettings::default().listen, &io::ErrorKind::AddrInUse.into());
        assert_eq!(refused.message, "cannot listen on 127.0.0.1:8317: the port is already in use");
    }
}
